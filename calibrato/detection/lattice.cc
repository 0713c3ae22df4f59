#include "calibrato/detection/lattice.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>

namespace calibrato {
namespace {

// How far from where it is expected a point may be, as a share of the step.
constexpr double kMaxSurprise = 0.4;

int64_t KeyOf(int row, int column) { return (int64_t{row} << 32) + int64_t{column}; }

class Growth {
 public:
  Growth(const std::vector<Eigen::Vector2d>& points, const PointIndex& index,
         const std::function<bool(int, int)>& may_be_neighbours)
      : points_(points), index_(index), may_be_neighbours_(may_be_neighbours) {}

  std::vector<LatticeNode> Grow(const LatticeSeed& seed) {
    Add({0, 0, seed.point}, seed.steps);
    for (size_t k = 0; k < nodes_.size(); ++k) {
      const LatticeNode node = nodes_[k];
      for (const auto& [rows, columns] : {std::pair(0, 1), {0, -1}, {1, 0}, {-1, 0}}) {
        Extend(k, node, rows, columns);
      }
    }
    return std::move(nodes_);
  }

 private:
  void Add(const LatticeNode& node, const Eigen::Matrix2d& steps) {
    at_[KeyOf(node.row, node.column)] = nodes_.size();
    is_taken_[node.point] = true;
    nodes_.push_back(node);
    steps_.push_back(steps);
  }

  std::optional<Eigen::Vector2d> At(int row, int column) const {
    const auto found = at_.find(KeyOf(row, column));
    if (found == at_.end()) return std::nullopt;
    return points_[static_cast<size_t>(nodes_[found->second].point)];
  }

  // The step from a node to its neighbour as those beside and before it tell.
  Eigen::Vector2d ExpectedStep(size_t k, const LatticeNode& node, int rows, int columns) const {
    const Eigen::Vector2d here = points_[static_cast<size_t>(node.point)];
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int count = 0;
    for (const int side : {-1, 1}) {
      const auto beside = At(node.row + side * columns, node.column + side * rows);
      const auto beyond = At(node.row + side * columns + rows, node.column + side * rows + columns);
      if (beside && beyond) {
        sum += *beyond - *beside;
        ++count;
      }
    }
    if (const auto before = At(node.row - rows, node.column - columns)) {
      sum += here - *before;
      ++count;
    }
    if (count > 0) return sum / count;
    return rows != 0 ? Eigen::Vector2d(rows * steps_[k].col(0))
                     : Eigen::Vector2d(columns * steps_[k].col(1));
  }

  void Extend(size_t k, const LatticeNode& node, int rows, int columns) {
    if (at_.contains(KeyOf(node.row + rows, node.column + columns))) return;
    const Eigen::Vector2d here = points_[static_cast<size_t>(node.point)];
    const Eigen::Vector2d step = ExpectedStep(k, node, rows, columns);
    const Eigen::Vector2d expected = here + step;
    const double radius = kMaxSurprise * step.norm();
    double nearest = radius * radius;
    int best = -1;
    index_.VisitNear(expected, radius, [&](int point) {
      const double distance = (points_[static_cast<size_t>(point)] - expected).squaredNorm();
      if (distance >= nearest || is_taken_.contains(point)) return;
      if (!may_be_neighbours_(node.point, point)) return;
      nearest = distance;
      best = point;
    });
    if (best < 0) return;
    Eigen::Matrix2d steps = steps_[k];
    const Eigen::Vector2d walked = points_[static_cast<size_t>(best)] - here;
    steps.col(rows != 0 ? 0 : 1) = (rows + columns) * walked;
    Add({node.row + rows, node.column + columns, best}, steps);
  }

  const std::vector<Eigen::Vector2d>& points_;
  const PointIndex& index_;
  const std::function<bool(int, int)>& may_be_neighbours_;
  std::vector<LatticeNode> nodes_;
  std::vector<Eigen::Matrix2d> steps_;  // of each node
  std::unordered_map<int64_t, size_t> at_;
  std::unordered_map<int, bool> is_taken_;
};

}  // namespace

PointIndex::PointIndex(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
  if (!points.empty()) {
    low_ = points.front();
    high = points.front();
  }
  for (const Eigen::Vector2d& point : points) {
    low_ = low_.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  // About two points a cell where they are spread evenly.
  const Eigen::Vector2d extent = high - low_;
  const double area = std::max(1.0, extent.x()) * std::max(1.0, extent.y());
  cell_size_ = std::max(4.0, std::sqrt(2.0 * area / std::max<double>(1.0, points.size())));
  width_ = static_cast<size_t>(extent.x() / cell_size_) + 1;
  height_ = static_cast<size_t>(extent.y() / cell_size_) + 1;
  cells_.resize(width_ * height_);
  for (size_t k = 0; k < points.size(); ++k) {
    const auto [u, v] = CellOf(points[k]);
    cells_[static_cast<size_t>(v) * width_ + static_cast<size_t>(u)].push_back(static_cast<int>(k));
  }
}

PointIndex::Cell PointIndex::CellOf(const Eigen::Vector2d& place) const {
  const auto cell = [&](double x, size_t count) {
    return static_cast<int>(std::clamp(x / cell_size_, 0.0, static_cast<double>(count) - 1.0));
  };
  return {cell(place.x() - low_.x(), width_), cell(place.y() - low_.y(), height_)};
}

std::vector<LatticeNode> GrowLattice(const std::vector<Eigen::Vector2d>& points,
                                     const PointIndex& index, const LatticeSeed& seed,
                                     const std::function<bool(int, int)>& may_be_neighbours) {
  return Growth(points, index, may_be_neighbours).Grow(seed);
}

std::vector<int> BlockOfLattice(const std::vector<LatticeNode>& nodes, int rows, int columns) {
  assert(rows >= 2 && columns >= 2);
  const auto num_corners = static_cast<size_t>(rows) * static_cast<size_t>(columns);
  if (10 * nodes.size() < 9 * num_corners) return {};
  const auto [low_row, high_row] = std::minmax_element(
      nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
  const auto [low_column, high_column] = std::minmax_element(
      nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.column < b.column; });
  const int height = high_row->row - low_row->row + 1;
  const int width = high_column->column - low_column->column + 1;
  std::vector<int> field(static_cast<size_t>(height) * static_cast<size_t>(width), -1);
  for (const LatticeNode& node : nodes) {
    field[static_cast<size_t>(node.row - low_row->row) * static_cast<size_t>(width) +
          static_cast<size_t>(node.column - low_column->column)] = node.point;
  }
  const auto at = [&](int row, int column) {
    const bool is_inside = row >= 0 && row < height && column >= 0 && column < width;
    return is_inside ? field[static_cast<size_t>(row) * static_cast<size_t>(width) +
                             static_cast<size_t>(column)]
                     : -1;
  };
  // How many points there are in a part of a row or column.
  const auto count = [&](int row, int column, int row_step, int column_step, int length) {
    int found = 0;
    for (int k = 0; k < length; ++k) {
      found += at(row + k * row_step, column + k * column_step) >= 0 ? 1 : 0;
    }
    return found;
  };
  const auto is_block = [&](int row, int column, int block_rows, int block_columns) {
    int found = 0;
    for (int r = 0; r < block_rows; ++r) found += count(row + r, column, 0, 1, block_columns);
    if (10 * found < 9 * block_rows * block_columns) return false;
    for (const int r : {row, row + block_rows - 1}) {
      if (2 * count(r, column, 0, 1, block_columns) < block_columns) return false;
    }
    for (const int c : {column, column + block_columns - 1}) {
      if (2 * count(row, c, 1, 0, block_rows) < block_rows) return false;
    }
    for (const int r : {row - 1, row + block_rows}) {
      if (2 * count(r, column, 0, 1, block_columns) >= block_columns) return false;
    }
    for (const int c : {column - 1, column + block_columns}) {
      if (2 * count(row, c, 1, 0, block_rows) >= block_rows) return false;
    }
    return true;
  };
  for (const bool is_turned : {false, true}) {
    const int block_rows = is_turned ? columns : rows;
    const int block_columns = is_turned ? rows : columns;
    for (int row = 0; row + block_rows <= height; ++row) {
      for (int column = 0; column + block_columns <= width; ++column) {
        if (!is_block(row, column, block_rows, block_columns)) continue;
        std::vector<int> block;
        for (int r = 0; r < rows; ++r) {
          for (int c = 0; c < columns; ++c) {
            block.push_back(is_turned ? at(row + c, column + r) : at(row + r, column + c));
          }
        }
        return block;
      }
    }
  }
  return {};
}

PixelGrid WithGapsFilled(const PixelGrid& grid, int rows, int columns) {
  const auto at = [&](int row, int column) -> std::optional<Eigen::Vector2d> {
    if (row < 0 || row >= rows || column < 0 || column >= columns) return std::nullopt;
    return grid[static_cast<size_t>(row) * static_cast<size_t>(columns) +
                static_cast<size_t>(column)];
  };
  const auto mean_of_neighbours = [&](int row, int column) -> std::optional<Eigen::Vector2d> {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int count = 0;
    for (const auto& [r, c] : {std::pair(0, 1), {1, 0}}) {
      const auto before = at(row - r, column - c);
      const auto behind = at(row + r, column + c);
      if (!before || !behind) continue;
      sum += 0.5 * (*before + *behind);
      ++count;
    }
    if (count == 0) return std::nullopt;
    return Eigen::Vector2d(sum / count);
  };
  const auto next_step = [&](int row, int column) -> std::optional<Eigen::Vector2d> {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int count = 0;
    for (const auto& [r, c] : {std::pair(0, 1), {0, -1}, {1, 0}, {-1, 0}}) {
      const auto next = at(row + r, column + c);
      const auto after = at(row + 2 * r, column + 2 * c);
      if (next && after) {
        sum += 2.0 * *next - *after;
        ++count;
      }
      const auto beside = at(row + c, column - r);
      const auto corner = at(row + r + c, column + c - r);
      if (next && beside && corner) {
        sum += *next + *beside - *corner;
        ++count;
      }
    }
    if (count == 0) return std::nullopt;
    return Eigen::Vector2d(sum / count);
  };
  PixelGrid filled = grid;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      auto& pixel = filled[static_cast<size_t>(row) * static_cast<size_t>(columns) +
                           static_cast<size_t>(column)];
      if (!pixel) pixel = mean_of_neighbours(row, column);
      if (!pixel) pixel = next_step(row, column);
    }
  }
  return filled;
}

}  // namespace calibrato
