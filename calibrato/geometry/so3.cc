#include "calibrato/geometry/so3.h"

#include <Eigen/SVD>
#include <cmath>

namespace calibrato {
namespace {

// Below this angle the closed forms lose digits to cancellation; three terms of the series are
// exact to rounding there (the next term is below 1e-18).
constexpr double kSmallAngle = 1e-3;

struct Coefficients {
  double sinc;             // sin(a) / a
  double one_minus_cos;    // (1 - cos a) / a^2
  double angle_minus_sin;  // (a - sin a) / a^3
};

Coefficients CoefficientsAt(double angle) {
  const double a2 = angle * angle;
  if (angle < kSmallAngle) {
    return {1.0 - a2 / 6.0 * (1.0 - a2 / 20.0), 0.5 - a2 / 24.0 * (1.0 - a2 / 30.0),
            1.0 / 6.0 - a2 / 120.0 * (1.0 - a2 / 42.0)};
  }
  const double half_sine = std::sin(0.5 * angle);
  return {std::sin(angle) / angle, 2.0 * half_sine * half_sine / a2,
          (angle - std::sin(angle)) / (a2 * angle)};
}

}  // namespace

Eigen::Matrix3d Hat(const Eigen::Vector3d& a) {
  Eigen::Matrix3d hat;
  hat << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return hat;
}

Eigen::Matrix3d ExpSo3(const Eigen::Vector3d& phi) {
  const Coefficients c = CoefficientsAt(phi.norm());
  const Eigen::Matrix3d hat = Hat(phi);
  return Eigen::Matrix3d::Identity() + c.sinc * hat + c.one_minus_cos * hat * hat;
}

Eigen::Vector3d LogSo3(const Eigen::Matrix3d& R) {
  // Through the quaternion, which keeps its digits at 0 and at pi.
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-9) return 2.0 * q.vec();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

Eigen::Matrix3d LeftJacobianSo3(const Eigen::Vector3d& phi) {
  const Coefficients c = CoefficientsAt(phi.norm());
  const Eigen::Matrix3d hat = Hat(phi);
  return Eigen::Matrix3d::Identity() + c.one_minus_cos * hat + c.angle_minus_sin * hat * hat;
}

Eigen::Matrix3d LeftJacobianInverseSo3(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d hat = Hat(phi);
  const double a2 = angle * angle;
  const double quadratic =
      angle < kSmallAngle
          ? 1.0 / 12.0 + a2 / 720.0 * (1.0 + a2 / 42.0)
          : (1.0 - 0.5 * angle * std::cos(0.5 * angle) / std::sin(0.5 * angle)) / a2;
  return Eigen::Matrix3d::Identity() - 0.5 * hat + quadratic * hat * hat;
}

Eigen::Matrix3d RightJacobianSo3(const Eigen::Vector3d& phi) { return LeftJacobianSo3(-phi); }

Eigen::Matrix3d RightJacobianInverseSo3(const Eigen::Vector3d& phi) {
  return LeftJacobianInverseSo3(-phi);
}

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& R) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

}  // namespace calibrato
