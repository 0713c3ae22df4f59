#include "calibrato/sensors/field_of_view.h"

#include <cmath>
#include <numbers>

#include "calibrato/sensors/focal_plane.h"

namespace calibrato {
namespace {

// Below this the quotients lose digits, and three terms of their series have them all.
constexpr double kSmall = 1e-2;

// atan(q) / q, and its derivative.
struct ArcTangentRatio {
  double value;
  double derivative;
};

ArcTangentRatio ComputeArcTangentRatio(double q) {
  const double s = q * q;
  if (q < kSmall) {
    return {1.0 - s * (1.0 / 3.0 - s * (1.0 / 5.0 - s / 7.0)),
            -q * (2.0 / 3.0 - s * (4.0 / 5.0 - s * 6.0 / 7.0))};
  }
  const double value = std::atan(q) / q;
  return {value, (1.0 / (1.0 + s) - value) / q};
}

}  // namespace

bool FieldOfView::SatisfiesConstraint(const Parameters& parameters) {
  return parameters(4) >= 0.0 && parameters(4) < std::numbers::pi;
}

FieldOfView::FieldOfView(const Parameters& parameters) : parameters_(parameters) {
  const double w = parameters(4);
  const double tangent = std::tan(0.5 * w);
  twice_tangent_ = 2.0 * tangent;
  twice_tangent_by_w_ = 1.0 + tangent * tangent;
  if (w < kSmall) {
    const double s = w * w;
    magnification_ = 1.0 + s * (1.0 / 12.0 + s * (1.0 / 120.0 + s * 17.0 / 20160.0));
    magnification_by_w_ = w * (1.0 / 6.0 + s * (1.0 / 30.0 + s * 17.0 / 3360.0));
  } else {
    magnification_ = twice_tangent_ / w;
    magnification_by_w_ = (twice_tangent_by_w_ - magnification_) / w;
  }
}

bool FieldOfView::Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel,
                          JacobianPoint* J_pixel_point,
                          JacobianParameters* J_pixel_parameters) const {
  if (!(p_c.z() > 0.0)) return false;
  const double inverse_z = 1.0 / p_c.z();
  const Eigen::Vector2d m = inverse_z * p_c.head<2>();
  const double r = m.norm();
  if (!std::isfinite(r)) return false;
  const double q = twice_tangent_ * r;
  const ArcTangentRatio ratio = ComputeArcTangentRatio(q);
  const Eigen::Vector4d k = parameters_.head<4>();
  const double across = magnification_ * ratio.value;  // r' / r
  const Eigen::Vector2d distorted = across * m;
  *pixel = PixelFromPlane(k, distorted);
  if (J_pixel_point != nullptr) {
    // d (across m) / d m = across I + growth m m^T, where growth = (d across / d r) / r.
    const double growth = r > 0.0 ? magnification_ * ratio.derivative * twice_tangent_ / r : 0.0;
    Eigen::Matrix2d J_m = growth * m * m.transpose();
    J_m.diagonal().array() += across;
    J_pixel_point->leftCols<2>() = (inverse_z * k.head<2>()).asDiagonal() * J_m;
    // The derivative of r' by r, written so that nothing cancels at large r.
    const double along = magnification_ / (1.0 + q * q);
    J_pixel_point->col(2) = -inverse_z * along * k.head<2>().cwiseProduct(m);
  }
  if (J_pixel_parameters != nullptr) {
    J_pixel_parameters->leftCols<4>() = PixelJacobianFocalAndCentre(distorted);
    const double across_by_w = magnification_by_w_ * ratio.value +
                               magnification_ * ratio.derivative * r * twice_tangent_by_w_;
    J_pixel_parameters->col(4) = across_by_w * k.head<2>().cwiseProduct(m);
  }
  return true;
}

std::optional<Eigen::Vector3d> FieldOfView::Unproject(const Eigen::Vector2d& pixel) const {
  const double w = parameters_(4);
  const Eigen::Vector2d distorted = PlaneFromPixel(parameters_.head<4>(), pixel);
  const double radius = distorted.norm();
  const double angle = w * radius;
  if (!(angle < 0.5 * std::numbers::pi)) return std::nullopt;
  // r / r' = tan(angle) / (angle magnification), by sines and cosines so that a ray near the edge
  // stays finite.
  const double sine_ratio = angle > 0.0 ? std::sin(angle) / angle : 1.0;
  const Eigen::Vector2d xy = sine_ratio / magnification_ * distorted;
  return Eigen::Vector3d(xy.x(), xy.y(), std::cos(angle)).normalized();
}

}  // namespace calibrato
