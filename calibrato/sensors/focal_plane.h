#pragma once

#include <Eigen/Core>

namespace calibrato {

// The last step of every camera model: from the plane at depth 1, where coordinates have no unit,
// to the pixel. k = fu fv pu pv [px].

inline Eigen::Vector2d PixelFromPlane(const Eigen::Vector4d& k, const Eigen::Vector2d& m) {
  return {k(0) * m.x() + k(2), k(1) * m.y() + k(3)};
}

inline Eigen::Vector2d PlaneFromPixel(const Eigen::Vector4d& k, const Eigen::Vector2d& pixel) {
  return {(pixel.x() - k(2)) / k(0), (pixel.y() - k(3)) / k(1)};
}

/// d pixel / d k.
inline Eigen::Matrix<double, 2, 4> PixelJacobianFocalAndCentre(const Eigen::Vector2d& m) {
  Eigen::Matrix<double, 2, 4> J;
  J << m.x(), 0.0, 1.0, 0.0, 0.0, m.y(), 0.0, 1.0;
  return J;
}

}  // namespace calibrato
