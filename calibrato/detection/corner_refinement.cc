#include "calibrato/detection/corner_refinement.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <variant>

#include "calibrato/detection/local_map.h"
#include "calibrato/detection/saddle_fit.h"
#include "calibrato/detection/stray_corners.h"

namespace calibrato {
namespace {

using Corners = std::vector<std::optional<Eigen::Vector2d>>;

// What is next to the window shines into it by the lens's blur.
constexpr double kBlurMargin = 1.3;  // [px]
// Shorter by the blur margin.
double Shrunk(double length_px) { return std::max(0.0, length_px - kBlurMargin); }

SaddleWindow WindowOf(const LocalMap& map, const CornerSurroundings& surroundings) {
  SaddleWindow window;
  window.centre = map.pixel;
  const Eigen::Matrix2d free = map.J_pixel_board * surroundings.free_edge_m.asDiagonal();
  const double area = std::abs(free.determinant());
  // Of the parallelogram of the free arms: the distances of its sides from the corner.
  const Eigen::Vector2d heights(area / free.col(1).norm(), area / free.col(0).norm());
  for (int k = 0; k < 2; ++k) window.arms.col(k) = Shrunk(heights(k)) / heights(k) * free.col(k);
  const Eigen::Vector2d side_heights =
      heights.cwiseProduct(surroundings.free_side_m * surroundings.free_edge_m.cwiseInverse());
  window.band = std::min({1.0, Shrunk(side_heights(0)) / Shrunk(heights(0)),
                          Shrunk(side_heights(1)) / Shrunk(heights(1))});
  return window;
}

// Corners dark where they should be bright, unless most are: then the board's colours are the other
// way round.
void RejectWrongColours(const std::vector<bool>& is_dark_ahead, const std::vector<bool>& is_dark,
                        Corners* corners, RejectionCounts* rejected) {
  std::ptrdiff_t balance = 0;
  for (size_t k = 0; k < corners->size(); ++k) {
    if ((*corners)[k]) balance += is_dark[k] == is_dark_ahead[k] ? 1 : -1;
  }
  for (size_t k = 0; k < corners->size(); ++k) {
    if (!(*corners)[k] || (is_dark[k] == is_dark_ahead[k]) == (balance >= 0)) continue;
    (*corners)[k].reset();
    ++rejected->corners_of_bad_fit;
  }
}

}  // namespace

std::vector<std::optional<Eigen::Vector2d>> RefineCorners(const GreyImage& image,
                                                          const Eigen::Matrix2Xd& board,
                                                          const Eigen::Matrix2Xd& pixels,
                                                          const std::vector<bool>& is_dark_ahead,
                                                          const CornerSurroundings& surroundings,
                                                          RejectionCounts* rejected) {
  const auto n = static_cast<size_t>(pixels.cols());
  Corners corners(n);
  const std::vector<LocalMap> maps = FitLocalMaps(board, pixels);
  std::vector<Eigen::Matrix2d> J_pixel_curvature(n, Eigen::Matrix2d::Zero());
  std::vector<bool> is_dark(n, false);
  for (size_t k = 0; k < n; ++k) {
    const auto fit = FitSaddle(image, WindowOf(maps[k], surroundings));
    if (const auto* saddle = std::get_if<SaddleFit>(&fit)) {
      corners[k] = saddle->pixel;
      J_pixel_curvature[k] = saddle->J_pixel_curvature;
      is_dark[k] = saddle->is_dark_between;
    } else if (std::get<SaddleFlaw>(fit) == SaddleFlaw::kNearBorder) {
      ++rejected->corners_near_border;
    } else {
      ++rejected->corners_of_bad_fit;
    }
  }
  RejectWrongColours(is_dark_ahead, is_dark, &corners, rejected);
  const std::vector<LocalMap> refined_maps =
      RemoveStrays(board, surroundings.free_edge_m, FitLocalMaps, 1.0, &corners, rejected);
  for (size_t k = 0; k < n; ++k) {
    if (!corners[k]) continue;
    const Eigen::Vector2d curvature(refined_maps[k].CurvatureAlong(Eigen::Vector2d::UnitX()),
                                    refined_maps[k].CurvatureAlong(Eigen::Vector2d::UnitY()));
    *corners[k] += J_pixel_curvature[k] * curvature;
  }
  return corners;
}

}  // namespace calibrato
