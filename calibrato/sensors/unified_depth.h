#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

namespace calibrato {

// What the unified models share: m = (X, Y) / D, where the depth D mixes the distance d of a point
// with its Z. In the form of Usenko et al., "The double sphere camera model", 3DV 2018,
// D = alpha d + (1 - alpha) Z; alpha = 0 is a pinhole, 1/2 the stereographic projection, 1 the
// orthographic one. Mei's xi is alpha / (1 - alpha), with D scaled by 1 + xi.

/// d m / d p, from d D / d p.
inline Eigen::Matrix<double, 2, 3> PlaneJacobianPoint(const Eigen::Vector2d& m,
                                                      double inverse_depth,
                                                      const Eigen::Vector3d& J_depth_p) {
  Eigen::Matrix<double, 2, 3> J;
  J << 1.0 - m.x() * J_depth_p.x(), -m.x() * J_depth_p.y(), -m.x() * J_depth_p.z(),
      -m.y() * J_depth_p.x(), 1.0 - m.y() * J_depth_p.y(), -m.y() * J_depth_p.z();
  return inverse_depth * J;
}

/// w such that the model holds for Z > -w d. Up to alpha = 1/2 the depth must be positive; from
/// there on the image radius must grow with the angle, which it does while alpha Z > -(1 - alpha)
/// d.
inline double UnifiedLimit(double alpha) {
  return alpha <= 0.5 ? alpha / (1.0 - alpha) : (1.0 - alpha) / alpha;
}

/// The Z of the point with X^2 + Y^2 = squared_radius and D = 1; nothing beyond the image radius
/// that the model reaches, 1 / sqrt(2 alpha - 1).
inline std::optional<double> UnifiedZ(double alpha, double squared_radius) {
  const double a = 2.0 * alpha - 1.0;
  const double squared_root = 1.0 - a * squared_radius;
  if (!(squared_root > 0.0)) return std::nullopt;
  const double root = alpha * std::sqrt(squared_root);
  // The same number twice: the first quotient fails near alpha = 1/2, the second outside [0, 1].
  if (std::abs(a) > 0.5) return (root - (1.0 - alpha)) / a;
  return (1.0 - alpha * alpha * squared_radius) / (root + 1.0 - alpha);
}

}  // namespace calibrato
