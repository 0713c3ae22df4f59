#include "calibrato/sensors/board_symmetry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "calibrato/geometry/so3.h"

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

struct Advice {
  std::string operator()(const Checkerboard&) const {
    return "use a checkerboard with an odd sum of rows and columns";
  }
  std::string operator()(const CircleGrid& board) const {
    if (board.asymmetric) return "use an asymmetric circle grid with an odd number of rows";
    return "use an asymmetric circle grid with an odd number of rows, or another kind of board";
  }
  std::string operator()(const AprilGrid&) const { return ""; }
  std::string operator()(const Charuco&) const { return ""; }
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

std::string SidedBoardAdvice(const Board& board) { return std::visit(Advice(), board); }

std::vector<BoardTurn> BoardTurns(const Board& board) {
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  const Eigen::Vector3d middle_g = points_g.rowwise().mean();
  std::vector<BoardTurn> turns;
  for (std::vector<int>& numbering : OtherNumberings(board)) {
    double sine = 0.0;
    double cosine = 0.0;
    for (size_t k = 0; k < numbering.size(); ++k) {
      const Eigen::Vector3d from = points_g.col(static_cast<Eigen::Index>(k)) - middle_g;
      const Eigen::Vector3d to = points_g.col(numbering[k]) - middle_g;
      sine += from.x() * to.y() - from.y() * to.x();
      cosine += from.dot(to);
    }
    const Eigen::Matrix3d R = ExpSo3({0.0, 0.0, std::atan2(sine, cosine)});
    turns.push_back({std::move(numbering), {R, middle_g - R * middle_g}});
  }
  return turns;
}

std::vector<int> ColumnsInOrder(const BoardView& view, const std::vector<int>& numbering) {
  std::vector<int> columns = ColumnsByNumber(view, numbering);
  std::erase(columns, -1);
  return columns;
}

BoardView Renumbered(const BoardView& view, const std::vector<int>& numbering,
                     const Eigen::Matrix3Xd& points_g) {
  BoardView numbered = view;
  numbered.corner_ids.clear();
  const std::vector<int> columns = ColumnsByNumber(view, numbering);
  Eigen::Index k = 0;
  for (size_t id = 0; id < columns.size(); ++id) {
    if (columns[id] < 0) continue;
    numbered.corner_ids.push_back(static_cast<int>(id));
    numbered.pixels.col(k) = view.pixels.col(columns[id]);
    numbered.points_g.col(k++) = points_g.col(static_cast<Eigen::Index>(id));
  }
  return numbered;
}

BoardView NumberedAsBefore(const BoardView& view, const BoardView& before,
                           const std::vector<std::vector<int>>& numberings,
                           const Eigen::Matrix3Xd& points_g) {
  if (numberings.empty()) return view;
  Numbering as_it_is(numberings.front().size());
  std::iota(as_it_is.begin(), as_it_is.end(), 0);
  double least = MeanSquaredTurn(view, ColumnsByNumber(view, as_it_is), before);
  const Numbering* best = nullptr;
  for (const Numbering& numbering : numberings) {
    const double turn = MeanSquaredTurn(view, ColumnsByNumber(view, numbering), before);
    if (!(turn < least)) continue;
    least = turn;
    best = &numbering;
  }
  return best == nullptr ? view : Renumbered(view, *best, points_g);
}

}  // namespace calibrato
