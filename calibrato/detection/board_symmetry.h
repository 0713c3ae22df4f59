#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/sensors/board.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// From how many sides a board looks the same: the numberings of its points, other than the one it
/// has, that no image can tell from it. Number k of a numbering is the point that is called k in
/// it. Empty for boards that tell their sides apart.
///
/// - Checkerboard: half a turn where rows + columns is even, quarter turns as well where rows and
///   columns are equal and even.
/// - Symmetric circle grid: half a turn, and quarter turns where rows and columns are equal.
/// - Asymmetric circle grid: half a turn where the number of rows is even.
[[nodiscard]] std::vector<std::vector<int>> OtherNumberings(const Board& board);

/// Of the ways to number a view's points, the one in which they are turned least against those of
/// an earlier view (mean squared distance of the points in both, relative to their middles): for a
/// board that keeps its numbers while it is rolled in front of the camera.
/// @param numberings  OtherNumberings of the board.
/// @param points_g    Its BoardPoints.
[[nodiscard]] BoardView NumberedAsBefore(const BoardView& view, const BoardView& before,
                                         const std::vector<std::vector<int>>& numberings,
                                         const Eigen::Matrix3Xd& points_g);

}  // namespace calibrato
