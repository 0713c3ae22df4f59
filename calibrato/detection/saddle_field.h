#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/detection/lattice.h"
#include "calibrato/detection/saddle_search.h"

namespace calibrato {

/// Saddles with the means to walk from one to the next along their edges.
class SaddleField {
 public:
  explicit SaddleField(std::vector<Saddle> saddles);
  SaddleField(const SaddleField&) = delete;
  SaddleField& operator=(const SaddleField&) = delete;

  const std::vector<Saddle>& saddles() const { return saddles_; }
  const Saddle& saddle(int k) const { return saddles_[static_cast<size_t>(k)]; }
  const std::vector<Eigen::Vector2d>& points() const { return points_; }
  const PointIndex& index() const { return index_; }

  /// Whether two saddles can be the ends of one edge. Along it dark and bright change sides: what
  /// is the first edge of one is the second of the other.
  bool MayBeNeighbours(int a, int b) const;

  /// The nearest of those in a direction (a unit vector), to within an angle of this sine.
  std::optional<int> NeighbourAlong(int k, const Eigen::Vector2d& direction, double max_sine) const;

  /// The nearest saddle to a place, at most `radius` [px] away.
  std::optional<int> NearestTo(const Eigen::Vector2d& place, double radius) const;

 private:
  std::vector<Saddle> saddles_;
  std::vector<Eigen::Vector2d> points_;
  PointIndex index_;
};

/// The lattices of at least so many saddles, such as the corners of a checkerboard; no saddle is in
/// two of them.
[[nodiscard]] std::vector<std::vector<LatticeNode>> SaddleLattices(const SaddleField& field,
                                                                   int min_nodes);

}  // namespace calibrato
