#include "calibrato/sensors/double_sphere.h"

#include <cmath>

#include "calibrato/sensors/focal_plane.h"
#include "calibrato/sensors/unified_depth.h"

namespace calibrato {

DoubleSphere::DoubleSphere(const Parameters& parameters)
    : parameters_(parameters), limit_(UnifiedLimit(parameters(1))) {}

bool DoubleSphere::Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel,
                           JacobianPoint* J_pixel_point,
                           JacobianParameters* J_pixel_parameters) const {
  const double xi = parameters_(0);
  const double alpha = parameters_(1);
  const Eigen::Vector4d k = parameters_.tail<4>();
  const double squared_radius = p_c.head<2>().squaredNorm();
  const double d1 = std::sqrt(squared_radius + p_c.z() * p_c.z());
  const double z2 = xi * d1 + p_c.z();
  const double d2 = std::sqrt(squared_radius + z2 * z2);
  if (!(z2 > -limit_ * d2 && d1 > -xi * p_c.z())) return false;
  const double inverse_depth = 1.0 / (alpha * d2 + (1.0 - alpha) * z2);
  const Eigen::Vector2d m = inverse_depth * p_c.head<2>();
  *pixel = PixelFromPlane(k, m);
  const double depth_by_z2 = alpha * z2 / d2 + 1.0 - alpha;
  if (J_pixel_point != nullptr) {
    const double slope = alpha / d2 + depth_by_z2 * xi / d1;
    *J_pixel_point =
        k.head<2>().asDiagonal() * PlaneJacobianPoint(m, inverse_depth,
                                                      {slope * p_c.x(), slope * p_c.y(),
                                                       depth_by_z2 * (1.0 + xi * p_c.z() / d1)});
  }
  if (J_pixel_parameters != nullptr) {
    const Eigen::Vector2d pixel_by_depth = -inverse_depth * k.head<2>().cwiseProduct(m);
    J_pixel_parameters->col(0) = depth_by_z2 * d1 * pixel_by_depth;
    J_pixel_parameters->col(1) = (d2 - z2) * pixel_by_depth;
    J_pixel_parameters->rightCols<4>() = PixelJacobianFocalAndCentre(m);
  }
  return true;
}

std::optional<Eigen::Vector3d> DoubleSphere::Unproject(const Eigen::Vector2d& pixel) const {
  const double xi = parameters_(0);
  const Eigen::Vector2d m = PlaneFromPixel(parameters_.tail<4>(), pixel);
  const double squared_radius = m.squaredNorm();
  const auto z2 = UnifiedZ(parameters_(1), squared_radius);
  if (!z2) return std::nullopt;
  // From the direction at the second sphere to the point of the first.
  const double squared_root = *z2 * *z2 + (1.0 - xi * xi) * squared_radius;
  if (!(squared_root >= 0.0)) return std::nullopt;
  const double scale = (*z2 * xi + std::sqrt(squared_root)) / (*z2 * *z2 + squared_radius);
  if (!(scale > 0.0)) return std::nullopt;
  return Eigen::Vector3d(scale * m.x(), scale * m.y(), scale * *z2 - xi);
}

}  // namespace calibrato
