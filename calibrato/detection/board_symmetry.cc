#include "calibrato/detection/board_symmetry.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace calibrato {
namespace {

using Numbering = std::vector<int>;

Numbering HalfTurn(int rows, int columns) {
  Numbering numbering(static_cast<size_t>(rows) * static_cast<size_t>(columns));
  std::iota(numbering.rbegin(), numbering.rend(), 0);
  return numbering;
}

// Of a square grid, by one or three quarters.
Numbering QuarterTurn(int side, bool is_forward) {
  Numbering numbering;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      numbering.push_back(is_forward ? column * side + (side - 1 - row)
                                     : (side - 1 - column) * side + row);
    }
  }
  return numbering;
}

std::vector<Numbering> Turns(int rows, int columns, bool has_half, bool has_quarters) {
  std::vector<Numbering> turns;
  if (has_half) turns.push_back(HalfTurn(rows, columns));
  if (has_quarters) {
    turns.push_back(QuarterTurn(rows, true));
    turns.push_back(QuarterTurn(rows, false));
  }
  return turns;
}

struct Symmetry {
  std::vector<Numbering> operator()(const Checkerboard& board) const {
    const bool is_even = (board.rows + board.columns) % 2 == 0;
    return Turns(board.rows, board.columns, is_even,
                 board.rows == board.columns && board.rows % 2 == 0);
  }
  std::vector<Numbering> operator()(const CircleGrid& board) const {
    if (board.asymmetric) return Turns(board.rows, board.columns, board.rows % 2 == 0, false);
    return Turns(board.rows, board.columns, true, board.rows == board.columns);
  }
  std::vector<Numbering> operator()(const AprilGrid&) const { return {}; }
  std::vector<Numbering> operator()(const Charuco&) const { return {}; }
};

// The view's columns by their numbers in a numbering, -1 where the view has no such point.
std::vector<int> ColumnsByNumber(const BoardView& view, const Numbering& numbering) {
  std::vector<int> column_of_id(numbering.size(), -1);
  for (size_t k = 0; k < view.corner_ids.size(); ++k) {
    column_of_id[static_cast<size_t>(view.corner_ids[k])] = static_cast<int>(k);
  }
  std::vector<int> columns;
  for (const int id : numbering) columns.push_back(column_of_id[static_cast<size_t>(id)]);
  return columns;
}

double MeanSquaredTurn(const BoardView& view, const std::vector<int>& columns,
                       const BoardView& before) {
  Eigen::Matrix2Xd now(2, before.num_corners());
  Eigen::Matrix2Xd then(2, before.num_corners());
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < before.num_corners(); ++k) {
    const int id = before.corner_ids[static_cast<size_t>(k)];
    const int column = columns[static_cast<size_t>(id)];
    if (column < 0) continue;
    now.col(count) = view.pixels.col(column);
    then.col(count++) = before.pixels.col(k);
  }
  if (count == 0) return std::numeric_limits<double>::infinity();
  const Eigen::Matrix2Xd change = now.leftCols(count) - then.leftCols(count);
  return (change.colwise() - change.rowwise().mean()).colwise().squaredNorm().mean();
}

}  // namespace

std::vector<std::vector<int>> OtherNumberings(const Board& board) {
  return std::visit(Symmetry(), board);
}

BoardView NumberedAsBefore(const BoardView& view, const BoardView& before,
                           const std::vector<std::vector<int>>& numberings,
                           const Eigen::Matrix3Xd& points_g) {
  if (numberings.empty()) return view;
  Numbering as_it_is(numberings.front().size());
  std::iota(as_it_is.begin(), as_it_is.end(), 0);
  std::vector<int> best = ColumnsByNumber(view, as_it_is);
  double least = MeanSquaredTurn(view, best, before);
  bool is_changed = false;
  for (const Numbering& numbering : numberings) {
    std::vector<int> columns = ColumnsByNumber(view, numbering);
    const double turn = MeanSquaredTurn(view, columns, before);
    if (!(turn < least)) continue;
    least = turn;
    best = std::move(columns);
    is_changed = true;
  }
  if (!is_changed) return view;
  BoardView numbered = view;
  numbered.corner_ids.clear();
  Eigen::Index k = 0;
  for (size_t id = 0; id < best.size(); ++id) {
    if (best[id] < 0) continue;
    numbered.corner_ids.push_back(static_cast<int>(id));
    numbered.pixels.col(k) = view.pixels.col(best[id]);
    numbered.points_g.col(k++) = points_g.col(static_cast<Eigen::Index>(id));
  }
  return numbered;
}

}  // namespace calibrato
