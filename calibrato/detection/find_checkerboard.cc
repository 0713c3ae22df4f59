#include "calibrato/detection/find_checkerboard.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "calibrato/detection/corner_order.h"
#include "calibrato/detection/corner_refinement.h"
#include "calibrato/detection/corner_view.h"
#include "calibrato/detection/lattice.h"
#include "calibrato/detection/saddle_field.h"
#include "calibrato/detection/saddle_search.h"

namespace calibrato {
namespace {

// Along the edges to the next corner, but for what the next corner's own edges need.
constexpr double kFreeShare = 0.85;

// A part of the background may look like one more row. Through a lens the spacing changes little
// from one square to the next: by 0.15 in ordinary photos, 0.6 at the edge of a fisheye's.
bool IsEvenlySpaced(const Eigen::Matrix2Xd& pixels, const Checkerboard& board) {
  constexpr double kMaxChange = 0.9;
  const auto is_even = [&](Eigen::Index middle, Eigen::Index step) {
    const Eigen::Vector2d before = pixels.col(middle) - pixels.col(middle - step);
    const Eigen::Vector2d after = pixels.col(middle + step) - pixels.col(middle);
    return (after - before).norm() <= kMaxChange * std::min(before.norm(), after.norm());
  };
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const Eigen::Index k = Eigen::Index{row} * board.columns + column;
      if (row > 0 && row + 1 < board.rows && !is_even(k, board.columns)) return false;
      if (column > 0 && column + 1 < board.columns && !is_even(k, 1)) return false;
    }
  }
  return true;
}

// The pixels of a block's points, with those of the missing ones estimated from their neighbours;
// nothing where one has too few.
std::optional<Eigen::Matrix2Xd> PixelsOf(const std::vector<int>& block, const SaddleField& field,
                                         const Checkerboard& board) {
  PixelGrid grid;
  for (const int point : block) {
    grid.push_back(point < 0 ? std::nullopt : std::optional(field.saddle(point).pixel));
  }
  grid = WithGapsFilled(grid, board.rows, board.columns);
  Eigen::Matrix2Xd pixels(2, board.rows * board.columns);
  for (Eigen::Index k = 0; k < pixels.cols(); ++k) {
    if (!grid[static_cast<size_t>(k)]) return std::nullopt;
    pixels.col(k) = *grid[static_cast<size_t>(k)];
  }
  return pixels;
}

// Every such board among the saddles, in order.
std::vector<Eigen::Matrix2Xd> BoardsAmong(const SaddleField& field, const GreyImage& image,
                                          const Checkerboard& board) {
  std::vector<Eigen::Matrix2Xd> boards;
  for (const std::vector<LatticeNode>& nodes :
       SaddleLattices(field, 9 * board.rows * board.columns / 10)) {
    const std::vector<int> block = BlockOfLattice(nodes, board.rows, board.columns);
    if (block.empty()) continue;
    const std::optional<Eigen::Matrix2Xd> pixels = PixelsOf(block, field, board);
    if (!pixels || !IsEvenlySpaced(*pixels, board)) continue;
    if (std::optional<Eigen::Matrix2Xd> ordered = OrderCorners(image, board, *pixels)) {
      boards.push_back(*std::move(ordered));
    }
  }
  return boards;
}

}  // namespace

std::optional<BoardView> FindCheckerboard(const GreyImage& image, const Checkerboard& board,
                                          RejectionCounts* rejected) {
  assert(board.rows >= 3 && board.columns >= 3);
  assert(image.pixels.size() ==
         static_cast<size_t>(image.resolution.width) * image.resolution.height);
  std::vector<Eigen::Matrix2Xd> boards;
  for (const int reduction : ReductionsToSearch(image.resolution)) {
    boards = BoardsAmong(SaddleField(FindSaddles(image, reduction)), image, board);
    if (!boards.empty()) break;
  }
  if (boards.size() > 1) ++rejected->images_with_two_boards;
  if (boards.size() != 1) return std::nullopt;

  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  const CornerSurroundings surroundings{
      {kFreeShare * board.row_spacing_m, kFreeShare * board.column_spacing_m},
      kFreeShare * std::min(board.row_spacing_m, board.column_spacing_m)};
  std::vector<bool> is_dark_ahead;
  for (int k = 0; k < board.rows * board.columns; ++k) {
    is_dark_ahead.push_back((k / board.columns + k % board.columns) % 2 == 0);
  }
  const std::vector<std::optional<Eigen::Vector2d>> corners = RefineCorners(
      image, points_g.topRows<2>(), boards.front(), is_dark_ahead, surroundings, rejected);
  std::optional<BoardView> view = ViewOf(corners, points_g);
  // Where a third is out of place, it was not the board.
  if (view && 3 * view->num_corners() < 2 * points_g.cols()) return std::nullopt;
  return view;
}

}  // namespace calibrato
