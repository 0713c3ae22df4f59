#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrato/geometry/rigid3.h"
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

/// What to do about a board of which there are OtherNumberings: "use a checkerboard with an odd sum
/// of rows and columns". "" for boards that tell their sides apart whatever their size.
[[nodiscard]] std::string SidedBoardAdvice(const Board& board);

/// The same as turns of the board onto itself.
struct BoardTurn {
  std::vector<int> numbering;
  /// points_g(numbering[k]) = T_g_turned * points_g(k): a view that is numbered anew shows the
  /// board at T_c_g * T_g_turned.
  Rigid3 T_g_turned;
};
[[nodiscard]] std::vector<BoardTurn> BoardTurns(const Board& board);

/// The columns of a view in the order of the numbers that they have in another numbering.
[[nodiscard]] std::vector<int> ColumnsInOrder(const BoardView& view,
                                              const std::vector<int>& numbering);

/// The view in another numbering, its corners in the order of their new numbers.
/// @param points_g  The board's BoardPoints.
[[nodiscard]] BoardView Renumbered(const BoardView& view, const std::vector<int>& numbering,
                                   const Eigen::Matrix3Xd& points_g);

/// Of the ways to number a view's points, the one in which they are turned least against those of
/// an earlier view (mean squared distance of the points in both, relative to their middles): for a
/// board that keeps its numbers while it is rolled in front of the camera.
/// @param numberings  OtherNumberings of the board.
/// @param points_g    Its BoardPoints.
[[nodiscard]] BoardView NumberedAsBefore(const BoardView& view, const BoardView& before,
                                         const std::vector<std::vector<int>>& numberings,
                                         const Eigen::Matrix3Xd& points_g);

}  // namespace calibrato
