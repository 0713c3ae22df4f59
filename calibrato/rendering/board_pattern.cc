#include "calibrato/rendering/board_pattern.h"

#include <numbers>

#include "calibrato/rendering/cell_outlines.h"
#include "calibrato/rendering/marker_bits.h"

namespace calibrato {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

BoardPattern::Outline Rectangle(const Vector2d& corner, const Vector2d& size) {
  const Vector2d x(size.x(), 0.0);
  const Vector2d y(0.0, size.y());
  return {corner, corner + x, corner + size, corner + y};
}

// The part of a board frame that a marker fills: its modules' rows and columns as one sees them.
struct MarkerPlace {
  Vector2d upper_left;
  Vector2d along_rows;     // from its top to its bottom
  Vector2d along_columns;  // from its left to its right
};

void AddMarker(const MarkerBits& bits, const MarkerPlace& place, BoardPattern* pattern) {
  const auto side = static_cast<double>(bits.size());
  for (const CellOutline& outline : OutlinesOfFalse(bits)) {
    BoardPattern::Outline corners;
    for (const auto& [row, column] : outline) {
      corners.emplace_back(place.upper_left + (row / side) * place.along_rows +
                           (column / side) * place.along_columns);
    }
    pattern->outlines.push_back(std::move(corners));
  }
}

// Squares counted from the one before corner (0, 0), which is black.
BoardPattern Squares(int rows, int columns, const Vector2d& size) {
  BoardPattern pattern;
  pattern.right = Vector2d::UnitY();
  for (int row = 0; row < rows; ++row) {
    for (int column = row % 2; column < columns; column += 2) {
      pattern.outlines.push_back(Rectangle(Vector2d(row - 1, column - 1).cwiseProduct(size), size));
    }
  }
  pattern.sheet = AlignedBox2d(-1.5 * size, Vector2d(rows - 0.5, columns - 0.5).cwiseProduct(size));
  return pattern;
}

BoardPattern Pattern(const Checkerboard& board) {
  return Squares(board.rows + 1, board.columns + 1, {board.row_spacing_m, board.column_spacing_m});
}

BoardPattern Pattern(const Charuco& board) {
  const double square = board.square_size_m;
  const double marker = board.marker_size_m;
  const double gap = 0.5 * (square - marker);
  BoardPattern pattern = Squares(board.rows, board.columns, {square, square});
  int id = 0;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 1 - row % 2; column < board.columns; column += 2) {
      const Vector2d corner((row - 1) * square + gap, (column - 1) * square + gap);
      AddMarker(DictionaryMarker(board.dictionary, id++),
                {corner, marker * Vector2d::UnitX(), marker * Vector2d::UnitY()}, &pattern);
    }
  }
  return pattern;
}

BoardPattern Pattern(const AprilGrid& board) {
  const double size = board.tag_size_m;
  const double gap = board.tag_spacing * size;
  const double pitch = size + gap;
  BoardPattern pattern;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const Vector2d upper_left(column * pitch, row * pitch + size);
      AddMarker(AprilGridTag(row * board.columns + column),
                {upper_left, -size * Vector2d::UnitY(), size * Vector2d::UnitX()}, &pattern);
    }
  }
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = 0; column <= board.columns; ++column) {
      pattern.outlines.push_back(Rectangle({column * pitch - gap, row * pitch - gap}, {gap, gap}));
    }
  }
  pattern.sheet = AlignedBox2d(Vector2d(-2.0 * gap, -2.0 * gap),
                               Vector2d(board.columns * pitch + gap, board.rows * pitch + gap));
  return pattern;
}

BoardPattern Pattern(const CircleGrid& board) {
  const double nearest = board.asymmetric ? std::numbers::sqrt2 * board.spacing_m : board.spacing_m;
  const Eigen::Matrix3Xd points = BoardPoints(board);
  BoardPattern pattern;
  if (!board.asymmetric) pattern.right = Vector2d::UnitY();
  for (const auto& point : points.colwise()) {
    pattern.discs.push_back({point.head<2>(), 0.25 * nearest});
  }
  const Vector2d margin(board.spacing_m, board.spacing_m);
  pattern.sheet = AlignedBox2d(points.topRows<2>().rowwise().minCoeff() - margin,
                               points.topRows<2>().rowwise().maxCoeff() + margin);
  return pattern;
}

}  // namespace

BoardPattern PatternOf(const Board& board) {
  return std::visit([](const auto& which) { return Pattern(which); }, board);
}

}  // namespace calibrato
