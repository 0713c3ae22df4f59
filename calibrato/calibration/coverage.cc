#include "calibrato/calibration/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calibrato/calibration/coverage_range.h"

namespace calibrato {
namespace {

// The pixels nearest to the four corners of the view's bounding box on the board, in order around
// it.
std::array<Eigen::Vector2d, 4> OuterCorners(const BoardView& view) {
  const Eigen::Matrix2Xd plane = view.points_g.topRows<2>();
  const Eigen::Vector2d low = plane.rowwise().minCoeff();
  const Eigen::Vector2d high = plane.rowwise().maxCoeff();
  const std::array<Eigen::Vector2d, 4> box = {
      {{low.x(), low.y()}, {low.x(), high.y()}, {high.x(), high.y()}, {high.x(), low.y()}}};
  std::array<Eigen::Vector2d, 4> corners;
  for (size_t i = 0; i < 4; ++i) {
    Eigen::Index nearest = 0;
    (plane.colwise() - box[i]).colwise().squaredNorm().minCoeff(&nearest);
    corners[i] = view.pixels.col(nearest);
  }
  return corners;
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

ViewParameters ViewParametersOf(const BoardView& view, Resolution resolution) {
  const auto [a, b, c, d] = OuterCorners(view);
  const double area = 0.5 * std::abs(Cross(c - a, d - b));
  const double side = std::sqrt(area);
  const Eigen::Vector2d mean = view.pixels.rowwise().mean();
  const double angle = std::atan2(std::abs(Cross(a - b, c - b)), (a - b).dot(c - b));
  const double width = resolution.width;
  const double height = resolution.height;
  const auto place = [side](double centre, double extent) {
    return extent > side ? std::clamp((centre - 0.5 * side) / (extent - side), 0.0, 1.0) : 0.5;
  };
  return {place(mean.x(), width), place(mean.y(), height), std::sqrt(area / (width * height)),
          std::min(1.0, 2.0 * std::abs(0.5 * std::numbers::pi - angle))};
}

Coverage CoverageOf(const std::vector<BoardView>& views, Resolution resolution) {
  CoverageRange range;
  for (const BoardView& view : views) range.Add(ViewParametersOf(view, resolution));
  return range.coverage();
}

}  // namespace calibrato
