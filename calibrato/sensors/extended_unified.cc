#include "calibrato/sensors/extended_unified.h"

#include <cmath>

#include "calibrato/sensors/focal_plane.h"
#include "calibrato/sensors/unified_depth.h"

namespace calibrato {

ExtendedUnified::ExtendedUnified(const Parameters& parameters)
    : parameters_(parameters), limit_(UnifiedLimit(parameters(0))) {}

bool ExtendedUnified::Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel,
                              JacobianPoint* J_pixel_point,
                              JacobianParameters* J_pixel_parameters) const {
  const double alpha = parameters_(0);
  const double beta = parameters_(1);
  const Eigen::Vector4d k = parameters_.tail<4>();
  const double squared_radius = p_c.head<2>().squaredNorm();
  const double d = std::sqrt(beta * squared_radius + p_c.z() * p_c.z());
  if (!(p_c.z() > -limit_ * d)) return false;
  const double inverse_depth = 1.0 / (alpha * d + (1.0 - alpha) * p_c.z());
  const Eigen::Vector2d m = inverse_depth * p_c.head<2>();
  *pixel = PixelFromPlane(k, m);
  const double slope = alpha / d;
  if (J_pixel_point != nullptr) {
    *J_pixel_point = k.head<2>().asDiagonal() *
                     PlaneJacobianPoint(m, inverse_depth,
                                        {slope * beta * p_c.x(), slope * beta * p_c.y(),
                                         slope * p_c.z() + 1.0 - alpha});
  }
  if (J_pixel_parameters != nullptr) {
    const Eigen::Vector2d pixel_by_depth = -inverse_depth * k.head<2>().cwiseProduct(m);
    J_pixel_parameters->col(0) = (d - p_c.z()) * pixel_by_depth;
    J_pixel_parameters->col(1) = 0.5 * slope * squared_radius * pixel_by_depth;
    J_pixel_parameters->rightCols<4>() = PixelJacobianFocalAndCentre(m);
  }
  return true;
}

std::optional<Eigen::Vector3d> ExtendedUnified::Unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d m = PlaneFromPixel(parameters_.tail<4>(), pixel);
  const auto z = UnifiedZ(parameters_(0), parameters_(1) * m.squaredNorm());
  if (!z) return std::nullopt;
  return Eigen::Vector3d(m.x(), m.y(), *z).normalized();
}

}  // namespace calibrato
