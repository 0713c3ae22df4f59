#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/detection/rejection.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// What surrounds a corner on the board, whose edges run along x and y.
struct CornerSurroundings {
  /// Along its edges nothing else comes nearer than this, (along x, along y) [m].
  Eigen::Vector2d free_edge_m = Eigen::Vector2d::Zero();
  /// Beside its edges nothing else comes nearer than this [m].
  double free_side_m = 0.0;
};

/// The corners to sub-pixels (saddle_fit.h), or nothing where one was rejected, which is counted.
/// The windows follow the board's image around each corner: its squares' size, however obliquely
/// they are seen, and how the lens bends its edges, as the other corners tell.
/// @param board  The corners on the board, (x, y) [m], at least four and not on one line.
/// @param pixels  About where they are [px].
/// @param is_dark_ahead  Of each corner, whether the quadrant between +x and +y is dark; or of each
/// the opposite, for boards printed with their colours exchanged.
[[nodiscard]] std::vector<std::optional<Eigen::Vector2d>> RefineCorners(
    const GreyImage& image, const Eigen::Matrix2Xd& board, const Eigen::Matrix2Xd& pixels,
    const std::vector<bool>& is_dark_ahead, const CornerSurroundings& surroundings,
    RejectionCounts* rejected);

}  // namespace calibrato
