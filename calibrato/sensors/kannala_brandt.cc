#include "calibrato/sensors/kannala_brandt.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibrato/sensors/first_root.h"
#include "calibrato/sensors/focal_plane.h"

namespace calibrato {

KannalaBrandt::KannalaBrandt(const Parameters& parameters) : parameters_(parameters) {
  constexpr double kPi = std::numbers::pi;
  const double squared_theta = FirstRoot(
      {3.0 * parameters(4), 5.0 * parameters(5), 7.0 * parameters(6), 9.0 * parameters(7)},
      kPi * kPi);
  max_theta_ = std::min(kPi, std::sqrt(squared_theta));
}

double KannalaBrandt::Radius(double theta) const {
  const double s = theta * theta;
  const auto& k = parameters_;
  return theta * (1.0 + s * (k(4) + s * (k(5) + s * (k(6) + s * k(7)))));
}

double KannalaBrandt::RadiusDerivative(double theta) const {
  const double s = theta * theta;
  const auto& k = parameters_;
  return 1.0 + s * (3.0 * k(4) + s * (5.0 * k(5) + s * (7.0 * k(6) + s * 9.0 * k(7))));
}

bool KannalaBrandt::Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel,
                            JacobianPoint* J_pixel_point,
                            JacobianParameters* J_pixel_parameters) const {
  const double squared_radius = p_c.head<2>().squaredNorm();
  const double z = p_c.z();
  const double r = std::sqrt(squared_radius);
  const double theta = std::atan2(r, z);
  // On the axis atan2(0, Z <= 0) has no direction to go to; NaN fails as well.
  if (!(theta < max_theta_ && (r > 0.0 || z > 0.0))) return false;
  const Eigen::Vector4d k = parameters_.head<4>();
  const double radius = Radius(theta);
  // On the axis itself every direction will do, since theta' / r is 1 / Z there.
  const Eigen::Vector2d direction =
      r > 0.0 ? Eigen::Vector2d(p_c.head<2>() / r) : Eigen::Vector2d(1.0, 0.0);
  const Eigen::Vector2d m = radius * direction;
  *pixel = PixelFromPlane(k, m);
  if (J_pixel_point != nullptr) {
    // Along the direction m moves with theta, across it in proportion to the radius.
    const double derivative = RadiusDerivative(theta) / (squared_radius + z * z);
    const double along = derivative * z;
    const double across = r > 0.0 ? radius / r : along;
    const double c = direction.x();
    const double s = direction.y();
    const double cross = (along - across) * c * s;
    *J_pixel_point << along * c * c + across * s * s, cross, -derivative * r * c, cross,
        along * s * s + across * c * c, -derivative * r * s;
    *J_pixel_point = (k.head<2>().asDiagonal() * *J_pixel_point).eval();
  }
  if (J_pixel_parameters != nullptr) {
    J_pixel_parameters->leftCols<4>() = PixelJacobianFocalAndCentre(m);
    const double s = theta * theta;
    Eigen::Vector2d column = (theta * s) * k.head<2>().cwiseProduct(direction);
    for (int i = 4; i < 8; ++i, column *= s) J_pixel_parameters->col(i) = column;
  }
  return true;
}

std::optional<Eigen::Vector3d> KannalaBrandt::Unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d m = PlaneFromPixel(parameters_.head<4>(), pixel);
  const double radius = m.norm();
  if (!(radius < Radius(max_theta_))) return std::nullopt;
  if (radius == 0.0) return Eigen::Vector3d(0.0, 0.0, 1.0);
  // Newton within a bracket that closes: the radius grows all the way to max_theta_.
  double low = 0.0;
  double high = max_theta_;
  double theta = std::min(radius, 0.5 * max_theta_);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double difference = Radius(theta) - radius;
    const double step = -difference / RadiusDerivative(theta);
    if (std::abs(step) <= 1e-15 * theta) break;
    (difference < 0.0 ? low : high) = theta;
    theta += step;
    if (!(theta > low && theta < high)) theta = 0.5 * (low + high);
  }
  const double scale = std::sin(theta) / radius;
  return Eigen::Vector3d(scale * m.x(), scale * m.y(), std::cos(theta));
}

}  // namespace calibrato
