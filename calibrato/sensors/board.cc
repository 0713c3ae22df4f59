#include "calibrato/sensors/board.h"

namespace calibrato {
namespace {

Eigen::Matrix3Xd Points(const Checkerboard& board) {
  Eigen::Matrix3Xd points(3, board.rows * board.columns);
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      points.col(row * board.columns + column) << row * board.row_spacing_m,
          column * board.column_spacing_m, 0.0;
    }
  }
  return points;
}

Eigen::Matrix3Xd Points(const AprilGrid& board) {
  const double pitch = (1.0 + board.tag_spacing) * board.tag_size_m;
  Eigen::Matrix3Xd points(3, 4 * board.rows * board.columns);
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const double left = column * pitch;
      const double bottom = row * pitch;
      const double right = left + board.tag_size_m;
      const double top = bottom + board.tag_size_m;
      points.middleCols<4>(4 * (row * board.columns + column)) << left, right, right, left,  //
          bottom, bottom, top, top,                                                          //
          0.0, 0.0, 0.0, 0.0;
    }
  }
  return points;
}

Eigen::Matrix3Xd Points(const CircleGrid& board) {
  if (!board.asymmetric) {
    return Points(Checkerboard{board.rows, board.columns, board.spacing_m, board.spacing_m});
  }
  Eigen::Matrix3Xd points(3, board.rows * board.columns);
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      points.col(row * board.columns + column) << (2 * column + row % 2) * board.spacing_m,
          row * board.spacing_m, 0.0;
    }
  }
  return points;
}

Eigen::Matrix3Xd Points(const Charuco& board) {
  return Points(
      Checkerboard{board.rows - 1, board.columns - 1, board.square_size_m, board.square_size_m});
}

std::string Millimetres(double metres) { return FormatNumber(1e3 * metres); }

std::string Size(int rows, int columns) {
  return std::to_string(rows) + " rows x " + std::to_string(columns) + " columns";
}

std::string Words(const Checkerboard& board) {
  return "checkerboard of " + Size(board.rows, board.columns) + " of inner corners, squares of " +
         Millimetres(board.row_spacing_m) + " x " + Millimetres(board.column_spacing_m) + " mm";
}

std::string Words(const AprilGrid& board) {
  return "AprilGrid of " + Size(board.rows, board.columns) + " of tags, " +
         Millimetres(board.tag_size_m) + " mm wide with gaps of " +
         Millimetres(board.tag_spacing * board.tag_size_m) + " mm";
}

std::string Words(const CircleGrid& board) {
  return std::string(board.asymmetric ? "asymmetric" : "symmetric") + " circle grid of " +
         Size(board.rows, board.columns) + ", spacing " + Millimetres(board.spacing_m) + " mm";
}

std::string Words(const Charuco& board) {
  return "ChArUco board of " + Size(board.rows, board.columns) + " of squares of " +
         Millimetres(board.square_size_m) + " mm with markers of " +
         Millimetres(board.marker_size_m) + " mm from " + board.dictionary;
}

}  // namespace

Eigen::Matrix3Xd BoardPoints(const Board& board) {
  return std::visit([](const auto& which) { return Points(which); }, board);
}

Eigen::Vector3d BoardCentre(const Board& board) {
  const Eigen::Matrix3Xd points = BoardPoints(board);
  return 0.5 * (points.rowwise().minCoeff() + points.rowwise().maxCoeff());
}

std::vector<std::pair<int, int>> NeighbouringPoints(const Board& board) {
  std::vector<std::pair<int, int>> pairs;
  if (const auto* grid = std::get_if<AprilGrid>(&board)) {
    for (int tag = 0; tag < grid->rows * grid->columns; ++tag) {
      pairs.emplace_back(4 * tag, 4 * tag + 1);
      pairs.emplace_back(4 * tag + 3, 4 * tag + 2);
    }
    return pairs;
  }
  int columns = 0;
  if (const auto* checkerboard = std::get_if<Checkerboard>(&board)) columns = checkerboard->columns;
  if (const auto* circles = std::get_if<CircleGrid>(&board)) columns = circles->columns;
  if (const auto* charuco = std::get_if<Charuco>(&board)) columns = charuco->columns - 1;
  const int num_points = static_cast<int>(BoardPoints(board).cols());
  for (int k = 1; k < num_points; ++k) {
    if (k % columns != 0) pairs.emplace_back(k - 1, k);
  }
  return pairs;
}

int PointsPerTag(const Board& board) { return std::holds_alternative<AprilGrid>(board) ? 4 : 1; }

std::string Describe(const Board& board) {
  return std::visit([](const auto& which) { return Words(which); }, board);
}

int PointsPerPart(const Board& board) {
  if (std::holds_alternative<Charuco>(board)) return 1;
  if (std::holds_alternative<AprilGrid>(board)) return PointsPerTag(board);
  return static_cast<int>(BoardPoints(board).cols());
}

}  // namespace calibrato
