#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

namespace calibrato {

/// Points of an image, sorted into cells, so that those near a place are found without looking at
/// all of them.
class PointIndex {
 public:
  /// The points must outlive the index.
  explicit PointIndex(const std::vector<Eigen::Vector2d>& points);

  /// Calls visit(k) for every point at most `radius` [px] away from a place, and for some others.
  template <typename Visit>
  void VisitNear(const Eigen::Vector2d& place, double radius, const Visit& visit) const {
    const auto [first_u, first_v] = CellOf(place.array() - radius);
    const auto [last_u, last_v] = CellOf(place.array() + radius);
    for (int v = first_v; v <= last_v; ++v) {
      for (int u = first_u; u <= last_u; ++u) {
        for (const int k : cells_[static_cast<size_t>(v) * width_ + static_cast<size_t>(u)]) {
          visit(k);
        }
      }
    }
  }

 private:
  struct Cell {
    int u;
    int v;
  };
  Cell CellOf(const Eigen::Vector2d& place) const;  // of those that exist, the nearest

  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double cell_size_ = 1.0;
  size_t width_ = 1;
  size_t height_ = 1;
  std::vector<std::vector<int>> cells_;
};

/// A point's place in a lattice of rows and columns, counted from any origin.
struct LatticeNode {
  int row = 0;
  int column = 0;
  int point = 0;  ///< Its index among the points.
};

/// How to walk from a first point to its neighbours.
struct LatticeSeed {
  int point = 0;
  Eigen::Matrix2d steps;  ///< Columns: to the next row, and to the next column [px].
};

/// The lattice of points that a seed belongs to, grown from point to neighbour: each next one is
/// looked for where its neighbours make it expected, so that lens and perspective may bend the
/// lattice as long as its steps change by less than half from one to the next. Each point is taken
/// once; the nodes come in the order in which they were found.
/// @param may_be_neighbours  Whether two points, by what they look like, can be one step apart.
[[nodiscard]] std::vector<LatticeNode> GrowLattice(
    const std::vector<Eigen::Vector2d>& points, const PointIndex& index, const LatticeSeed& seed,
    const std::function<bool(int from, int to)>& may_be_neighbours);

/// The block of `rows` x `columns` that a lattice is, as point numbers at row * columns + column,
/// -1 where a point is missing. Nothing where more than a tenth of the points are missing, fewer
/// than half in a row or column at its border, or where the lattice goes on beside the block by
/// half a row or column: then it is another board.
/// Which of its four corners is (0, 0), and whether it is mirrored, is left open.
[[nodiscard]] std::vector<int> BlockOfLattice(const std::vector<LatticeNode>& nodes, int rows,
                                              int columns);

/// A grid of rows x columns, at row * columns + column, where known.
using PixelGrid = std::vector<std::optional<Eigen::Vector2d>>;

/// With the gaps filled that have neighbours enough: by the mean of what is before and behind in a
/// row or column, or else by the next step of a row, of a column, or of a parallelogram. Each gap
/// is filled from what was known before.
[[nodiscard]] PixelGrid WithGapsFilled(const PixelGrid& grid, int rows, int columns);

}  // namespace calibrato
