#include "calibrato/sensors/unified_omni.h"

#include <cmath>

#include "calibrato/sensors/focal_plane.h"
#include "calibrato/sensors/unified_depth.h"

namespace calibrato {

template <int kNumDistortion>
UnifiedOmni<kNumDistortion>::UnifiedOmni(const Parameters& parameters)
    : parameters_(parameters),
      limit_(parameters(0) <= 1.0 ? parameters(0) : 1.0 / parameters(0)),
      distortion_(parameters.template tail<kNumDistortion>()) {}

template <int kNumDistortion>
bool UnifiedOmni<kNumDistortion>::Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel,
                                          JacobianPoint* J_pixel_point,
                                          JacobianParameters* J_pixel_parameters) const {
  const double d = p_c.norm();
  if (!(p_c.z() > -limit_ * d)) return false;
  const double xi = parameters_(0);
  const Eigen::Vector4d k = parameters_.template segment<4>(1);
  const double inverse_depth = 1.0 / (p_c.z() + xi * d);
  const Eigen::Vector2d m = inverse_depth * p_c.head<2>();
  const bool with_jacobian = J_pixel_point != nullptr || J_pixel_parameters != nullptr;
  Eigen::Vector2d distorted;
  Eigen::Matrix2d J_m;
  typename RadialTangential<kNumDistortion>::JacobianCoefficients J_distortion;
  if (!distortion_.Distort(m, &distorted, with_jacobian ? &J_m : nullptr,
                           J_pixel_parameters != nullptr ? &J_distortion : nullptr)) {
    return false;
  }
  *pixel = PixelFromPlane(k, distorted);
  if (!with_jacobian) return true;
  const Eigen::Matrix2d J_pixel_m = k.head<2>().asDiagonal() * J_m;
  if (J_pixel_point != nullptr) {
    const double slope = xi / d;
    *J_pixel_point =
        J_pixel_m * PlaneJacobianPoint(m, inverse_depth,
                                       {slope * p_c.x(), slope * p_c.y(), 1.0 + slope * p_c.z()});
  }
  if (J_pixel_parameters != nullptr) {
    J_pixel_parameters->col(0) = J_pixel_m * (-d * inverse_depth * m);
    J_pixel_parameters->template middleCols<4>(1) = PixelJacobianFocalAndCentre(distorted);
    if constexpr (kNumDistortion > 0) {
      J_pixel_parameters->template rightCols<kNumDistortion>() =
          k.head<2>().asDiagonal() * J_distortion;
    }
  }
  return true;
}

template <int kNumDistortion>
std::optional<Eigen::Vector3d> UnifiedOmni<kNumDistortion>::Unproject(
    const Eigen::Vector2d& pixel) const {
  const auto m = distortion_.Undistort(PlaneFromPixel(parameters_.template segment<4>(1), pixel));
  if (!m) return std::nullopt;
  const double xi = parameters_(0);
  const double squared_radius = m->squaredNorm();
  const double squared_root = 1.0 + (1.0 - xi * xi) * squared_radius;
  if (!(squared_root > 0.0)) return std::nullopt;
  const double scale = (xi + std::sqrt(squared_root)) / (squared_radius + 1.0);
  return Eigen::Vector3d(scale * m->x(), scale * m->y(), scale - xi);
}

template class UnifiedOmni<0>;
template class UnifiedOmni<4>;

}  // namespace calibrato
