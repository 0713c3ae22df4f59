#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// A board that is not flat, to second order: over its plane it stands out by
///
///     z(x, y) = a x^2 + b x y + c y^2 - m
///
/// with x, y [m] counted from the board's middle and m such that z is zero on average over the
/// corners (a shift or tilt of the whole board would be its pose's business).
struct BoardBending {
  Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();  ///< a, b, c [1/m].
};

/// The three shapes that bending is made of, over one board: fixed by the corners seen at all,
/// whatever part of them one view holds.
class BendingShapes {
 public:
  /// The middle is that of the bounding box of all corners in the views; each corner counts once.
  explicit BendingShapes(const std::vector<const BoardView*>& views);

  /// (x^2, x y, y^2) less their means, at a point of the flat board [m^2].
  [[nodiscard]] Eigen::Vector3d At(const Eigen::Vector3d& point_g) const;
  /// The view of a flat board, with its points where the bent one has them.
  [[nodiscard]] BoardView Bent(const BoardView& view, const BoardBending& bending) const;
  /// From the lowest to the highest point of the bent board [m].
  [[nodiscard]] double Depth(const BoardBending& bending) const;

 private:
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3Xd corners_g_;
};

}  // namespace calibrato
