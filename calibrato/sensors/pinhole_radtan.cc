#include "calibrato/sensors/pinhole_radtan.h"

#include "calibrato/sensors/focal_plane.h"

namespace calibrato {

template <int kNumDistortion>
PinholeRadtan<kNumDistortion>::PinholeRadtan(const Parameters& parameters)
    : parameters_(parameters), distortion_(parameters.template tail<kNumDistortion>()) {}

template <int kNumDistortion>
bool PinholeRadtan<kNumDistortion>::Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel,
                                            JacobianPoint* J_pixel_point,
                                            JacobianParameters* J_pixel_parameters) const {
  if (!(p_c.z() > 0.0)) return false;
  const double inverse_z = 1.0 / p_c.z();
  const Eigen::Vector2d m = inverse_z * p_c.head<2>();
  const Eigen::Vector4d k = parameters_.template head<4>();
  Eigen::Vector2d distorted;
  Eigen::Matrix2d J_m;
  typename RadialTangential<kNumDistortion>::JacobianCoefficients J_distortion;
  if (!distortion_.Distort(m, &distorted, J_pixel_point != nullptr ? &J_m : nullptr,
                           J_pixel_parameters != nullptr ? &J_distortion : nullptr)) {
    return false;
  }
  *pixel = PixelFromPlane(k, distorted);
  if (J_pixel_point != nullptr) {
    J_pixel_point->leftCols<2>() = (inverse_z * k.head<2>()).asDiagonal() * J_m;
    J_pixel_point->col(2) = -(J_pixel_point->col(0) * m.x() + J_pixel_point->col(1) * m.y());
  }
  if (J_pixel_parameters != nullptr) {
    J_pixel_parameters->template leftCols<4>() = PixelJacobianFocalAndCentre(distorted);
    if constexpr (kNumDistortion > 0) {
      J_pixel_parameters->template rightCols<kNumDistortion>() =
          k.head<2>().asDiagonal() * J_distortion;
    }
  }
  return true;
}

template <int kNumDistortion>
std::optional<Eigen::Vector3d> PinholeRadtan<kNumDistortion>::Unproject(
    const Eigen::Vector2d& pixel) const {
  const auto m = distortion_.Undistort(PlaneFromPixel(parameters_.template head<4>(), pixel));
  if (!m) return std::nullopt;
  return Eigen::Vector3d(m->x(), m->y(), 1.0);
}

template class PinholeRadtan<0>;
template class PinholeRadtan<4>;
template class PinholeRadtan<5>;

}  // namespace calibrato
