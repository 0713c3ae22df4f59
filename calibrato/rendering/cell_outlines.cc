#include "calibrato/rendering/cell_outlines.h"

#include <array>

namespace calibrato {
namespace {

// Directions of a step from corner to corner, each a left turn after the one before.
constexpr std::array<std::pair<int, int>, 4> kSteps = {std::pair{1, 0}, {0, 1}, {-1, 0}, {0, -1}};

class Grid {
 public:
  explicit Grid(const std::vector<std::vector<bool>>& cells)
      : cells_(cells),
        rows_(static_cast<int>(cells.size())),
        columns_(rows_ == 0 ? 0 : static_cast<int>(cells.front().size())),
        left_(static_cast<size_t>(rows_ + 1) * (columns_ + 1)) {}

  std::vector<CellOutline> Outlines() {
    std::vector<CellOutline> outlines;
    for (int row = 0; row <= rows_; ++row) {
      for (int column = 0; column <= columns_; ++column) {
        for (int direction = 0; direction < 4; ++direction) {
          if (IsSide(row, column, direction) && !Left(row, column)[direction]) {
            outlines.push_back(Follow(row, column, direction));
          }
        }
      }
    }
    return outlines;
  }

 private:
  bool IsFalse(int row, int column) const {
    return row >= 0 && row < rows_ && column >= 0 && column < columns_ && !cells_[row][column];
  }

  // The cells to the left and to the right of a step.
  bool IsSide(int row, int column, int direction) const {
    switch (direction) {
      case 0:
        return IsFalse(row, column) && !IsFalse(row, column - 1);
      case 1:
        return IsFalse(row - 1, column) && !IsFalse(row, column);
      case 2:
        return IsFalse(row - 1, column - 1) && !IsFalse(row - 1, column);
      default:
        return IsFalse(row, column - 1) && !IsFalse(row - 1, column - 1);
    }
  }

  std::array<bool, 4>& Left(int row, int column) {
    return left_[static_cast<size_t>(row) * (columns_ + 1) + column];
  }

  CellOutline Follow(int row, int column, int direction) {
    CellOutline outline;
    while (!Left(row, column)[direction]) {
      Left(row, column)[direction] = true;
      outline.emplace_back(row, column);
      row += kSteps[direction].first;
      column += kSteps[direction].second;
      // Left first, around the same cell; straight on; right.
      for (const int turn : {1, 0, 3}) {
        const int next = (direction + turn) % 4;
        if (!IsSide(row, column, next)) continue;
        direction = next;
        break;
      }
    }
    return WithoutStraightCorners(outline);
  }

  static CellOutline WithoutStraightCorners(const CellOutline& outline) {
    CellOutline corners;
    const size_t size = outline.size();
    for (size_t k = 0; k < size; ++k) {
      const auto& before = outline[(k + size - 1) % size];
      const auto& after = outline[(k + 1) % size];
      if (before.first != after.first && before.second != after.second) {
        corners.push_back(outline[k]);
      }
    }
    return corners;
  }

  const std::vector<std::vector<bool>>& cells_;
  int rows_;
  int columns_;
  std::vector<std::array<bool, 4>> left_;  // behind us: sides that an outline has, by their start
};

}  // namespace

std::vector<CellOutline> OutlinesOfFalse(const std::vector<std::vector<bool>>& cells) {
  return Grid(cells).Outlines();
}

}  // namespace calibrato
