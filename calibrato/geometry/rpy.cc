#include "calibrato/geometry/rpy.h"

#include <Eigen/Geometry>
#include <cmath>

namespace calibrato {

Eigen::Matrix3d RotationFromRpy(const Eigen::Vector3d& rpy) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(rpy.z(), Vector3d::UnitZ()) * AngleAxisd(rpy.y(), Vector3d::UnitY()) *
          AngleAxisd(rpy.x(), Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Vector3d RpyFromRotation(const Eigen::Matrix3d& R) {
  const double cosine_pitch = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cosine_pitch);
  if (cosine_pitch < 1e-12) return {0.0, pitch, std::atan2(-R(0, 1), R(1, 1))};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

Eigen::Matrix3d AngularVelocityFromRpyRates(const Eigen::Vector3d& rpy) {
  const double cp = std::cos(rpy.y());
  const double sp = std::sin(rpy.y());
  const double cy = std::cos(rpy.z());
  const double sy = std::sin(rpy.z());
  Eigen::Matrix3d E;
  E << cy * cp, -sy, 0.0, sy * cp, cy, 0.0, -sp, 0.0, 1.0;
  return E;
}

Eigen::Vector3d AngularAccelerationFromRpy(const Eigen::Vector3d& rpy, const Eigen::Vector3d& rates,
                                           const Eigen::Vector3d& accelerations) {
  const double cp = std::cos(rpy.y());
  const double sp = std::sin(rpy.y());
  const double cy = std::cos(rpy.z());
  const double sy = std::sin(rpy.z());
  const double dp = rates.y();
  const double dy = rates.z();
  Eigen::Matrix3d E_dot;
  E_dot << -sy * cp * dy - cy * sp * dp, -cy * dy, 0.0, cy * cp * dy - sy * sp * dp, -sy * dy, 0.0,
      -cp * dp, 0.0, 0.0;
  return E_dot * rates + AngularVelocityFromRpyRates(rpy) * accelerations;
}

}  // namespace calibrato
