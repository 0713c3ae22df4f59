#include "calibrato/diagnosis/image_quality.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

#include "calibrato/diagnosis/upper_median.h"

namespace calibrato {
namespace {

using Eigen::Vector2d;
using Edges = std::vector<std::pair<int, int>>;  // Corner ids.

// Edges between points, of two directions, and how far from them, in their length, nothing else is
// drawn on the board.
struct BoardEdges {
  Edges rows;
  Edges columns;
  double reach = 0.0;
};

constexpr double kNearest = 3.5;        // A profile reaches at least so far to either side [px] ...
constexpr double kFarthest = 15.0;      // ... and at most so far.
constexpr double kStep = 0.5;           // Along a profile [px].
constexpr double kLeastContrast = 5.0;  // Of an edge that is one [grey levels].

constexpr double kBlurred = 5.0;           // [px]
constexpr double kUnscaledWidth = 1280.0;  // [px]
constexpr double kFullPixel = 250.0;
constexpr double kLowContrast = 40.0;
constexpr double kAllButBlack = 10.0;
constexpr double kAllButWhite = 245.0;
constexpr double kManyImages = 0.2;

struct EdgesOf {
  BoardEdges operator()(const Checkerboard& board) const {
    return {NeighbouringPoints(board), Downwards(board.rows, board.columns), 0.3};
  }
  BoardEdges operator()(const Charuco& board) const {
    const double margin = 0.5 * (1.0 - board.marker_size_m / board.square_size_m);
    return {NeighbouringPoints(board), Downwards(board.rows - 1, board.columns - 1),
            std::min(0.3, margin)};
  }
  BoardEdges operator()(const AprilGrid& board) const {
    Edges upright;
    for (int tag = 0; tag < board.rows * board.columns; ++tag) {
      upright.emplace_back(4 * tag, 4 * tag + 3);
      upright.emplace_back(4 * tag + 1, 4 * tag + 2);
    }
    // The tag's border is a fifth of its side wide.
    return {NeighbouringPoints(board), upright, std::min(0.18, board.tag_spacing)};
  }
  BoardEdges operator()(const CircleGrid&) const { return {}; }

  static Edges Downwards(int rows, int columns) {
    Edges edges;
    for (int id = 0; id < (rows - 1) * columns; ++id) edges.emplace_back(id, id + columns);
    return edges;
  }
};

// Bilinear. @pre pixel lies in the image.
double GreyAt(const GreyImage& image, const Vector2d& pixel) {
  const auto u = static_cast<int>(pixel.x());
  const auto v = static_cast<int>(pixel.y());
  const double du = pixel.x() - u;
  const double dv = pixel.y() - v;
  const auto at = [&](int x, int y) {
    const auto column = static_cast<size_t>(std::min(x, image.resolution.width - 1));
    const auto row = static_cast<size_t>(std::min(y, image.resolution.height - 1));
    return static_cast<double>(
        image.pixels[row * static_cast<size_t>(image.resolution.width) + column]);
  };
  return (1.0 - dv) * ((1.0 - du) * at(u, v) + du * at(u + 1, v)) +
         dv * ((1.0 - du) * at(u, v + 1) + du * at(u + 1, v + 1));
}

bool IsInside(const GreyImage& image, const Vector2d& pixel) {
  return pixel.minCoeff() >= 0.0 && pixel.x() <= image.resolution.width - 1 &&
         pixel.y() <= image.resolution.height - 1;
}

struct Profile {
  double width_px;
  double black;
  double white;
};

std::optional<Profile> ProfileAcross(const GreyImage& image, const Vector2d& a, const Vector2d& b,
                                     double reach_of_edge) {
  const double length = (b - a).norm();
  const double reach = std::min(kFarthest, reach_of_edge * length);
  if (!(reach >= kNearest)) return std::nullopt;
  const Vector2d middle = 0.5 * (a + b);
  const Vector2d along = (b - a) / length;
  const Vector2d across(-along.y(), along.x());
  if (!IsInside(image, middle + reach * across) || !IsInside(image, middle - reach * across)) {
    return std::nullopt;
  }
  // A few lines beside each other, so that the sensor's noise makes no slope of its own.
  const auto num_steps = static_cast<int>(2.0 * reach / kStep);
  std::vector<double> grey(static_cast<size_t>(num_steps) + 1, 0.0);
  constexpr int kLines = 2;
  for (int k = 0; k <= num_steps; ++k) {
    for (int line = -kLines; line <= kLines; ++line) {
      const Vector2d pixel = middle + (k * kStep - reach) * across + line * along;
      grey[static_cast<size_t>(k)] +=
          IsInside(image, pixel) ? GreyAt(image, pixel) / (2 * kLines + 1) : 0.0;
    }
  }
  const size_t end = grey.size() / 6 + 1;
  const auto mean = [&](size_t begin) {
    return std::accumulate(grey.begin() + static_cast<std::ptrdiff_t>(begin),
                           grey.begin() + static_cast<std::ptrdiff_t>(begin + end), 0.0) /
           static_cast<double>(end);
  };
  const double one = mean(0);
  const double other = mean(grey.size() - end);
  const double contrast = std::abs(other - one);
  if (!(contrast >= kLeastContrast)) return std::nullopt;
  double slope = 0.0;
  for (size_t k = 2; k < grey.size(); ++k) {
    slope = std::max(slope, std::abs(grey[k] - grey[k - 2]) / (2.0 * kStep));
  }
  return Profile{contrast / slope, std::min(one, other), std::max(one, other)};
}

}  // namespace

std::optional<BoardSharpness> SharpnessOf(const GreyImage& image, const BoardView& view,
                                          const Board& board) {
  std::map<int, Eigen::Index> places;
  for (size_t k = 0; k < view.corner_ids.size(); ++k) {
    places[view.corner_ids[k]] = static_cast<Eigen::Index>(k);
  }
  const BoardEdges of_board = std::visit(EdgesOf(), board);
  BoardSharpness sharpness;
  std::vector<double> black;
  std::vector<double> white;
  for (const Edges* edges : {&of_board.rows, &of_board.columns}) {
    std::vector<double> widths;
    for (const auto& [one, other] : *edges) {
      const auto a = places.find(one);
      const auto b = places.find(other);
      if (a == places.end() || b == places.end()) continue;
      const auto profile = ProfileAcross(image, view.pixels.col(a->second),
                                         view.pixels.col(b->second), of_board.reach);
      if (!profile) continue;
      widths.push_back(profile->width_px);
      black.push_back(profile->black);
      white.push_back(profile->white);
    }
    sharpness.edge_width_px = std::max(sharpness.edge_width_px, UpperMedian(widths));
  }
  if (white.empty()) return std::nullopt;
  sharpness.black = UpperMedian(std::move(black));
  sharpness.white = UpperMedian(std::move(white));
  return sharpness;
}

double BrightnessOf(const GreyImage& image) {
  const int64_t sum = std::accumulate(image.pixels.begin(), image.pixels.end(), int64_t{0});
  return static_cast<double>(sum) / static_cast<double>(std::max<size_t>(1, image.pixels.size()));
}

std::vector<Finding> FindingsOnImages(const std::string& camera,
                                      const std::vector<ImageQuality>& images,
                                      Resolution resolution) {
  const double limit_px = kBlurred * std::max(1.0, resolution.width / kUnscaledWidth);
  std::vector<double> widths;
  std::vector<double> brightness;
  size_t num_blurred = 0;
  size_t num_full = 0;
  size_t num_faint = 0;
  for (const ImageQuality& image : images) {
    brightness.push_back(image.brightness);
    if (!image.board) continue;
    widths.push_back(image.board->edge_width_px);
    if (image.board->edge_width_px > limit_px) ++num_blurred;
    if (image.board->white >= kFullPixel) ++num_full;
    if (image.board->white - image.board->black < kLowContrast) ++num_faint;
  }
  std::vector<Finding> findings;
  const auto is_many = [&](size_t count) {
    return static_cast<double>(count) > kManyImages * static_cast<double>(widths.size());
  };
  const auto of_all = [&](size_t count) {
    return Format("%zu of %zu images that were looked at", count, widths.size());
  };
  if (is_many(num_blurred)) {
    findings.push_back(
        {Severity::kWarn,
         camera + ": in " + of_all(num_blurred) +
             Format(" the board is blurred: its edges are %.1f px wide (median), sharp ones 2",
                    UpperMedian(widths)),
         "move more slowly, with more light or a shorter exposure; if it is so at rest, focus"});
  }
  if (is_many(num_full)) {
    findings.push_back({Severity::kWarn,
                        camera + ": in " + of_all(num_full) +
                            " the board's white is at the end of the sensor's range",
                        "expose for less time: white that overflows moves edges"});
  }
  if (is_many(num_faint)) {
    findings.push_back({Severity::kWarn,
                        camera + ": in " + of_all(num_faint) +
                            Format(" the board's black and white differ by less than %.0f of 255 "
                                   "grey levels",
                                   kLowContrast),
                        "take more light, or expose for longer if the rig moves slowly"});
  }
  if (images.empty()) return findings;
  const double median = UpperMedian(std::move(brightness));
  if (median < kAllButBlack || median > kAllButWhite) {
    findings.push_back({Severity::kWarn,
                        camera + Format(": the images are all but %s (%.0f of 255, median)",
                                        median < kAllButBlack ? "black" : "white", median),
                        "check the exposure and the lens's cap"});
  }
  return findings;
}

}  // namespace calibrato
