#pragma once

#include <Eigen/Core>

namespace calibrato {

/// Fixed-axis roll, pitch, yaw [rad]: R = Rz(yaw) Ry(pitch) Rx(roll), the angles of the actions and
/// of the paper's relative error (tf's setRPY).
[[nodiscard]] Eigen::Matrix3d RotationFromRpy(const Eigen::Vector3d& rpy);

/// pitch in [-pi/2, pi/2], roll and yaw in (-pi, pi]. At |pitch| = pi/2 roll is set to zero.
[[nodiscard]] Eigen::Vector3d RpyFromRotation(const Eigen::Matrix3d& R);

/// E with omega_a = E d(rpy)/dt: the angular velocity of frame b in frame a for R_a_b(rpy). Also
/// the Jacobian of the left perturbation dtheta of R_a_b to rpy. Singular at |pitch| = pi/2.
[[nodiscard]] Eigen::Matrix3d AngularVelocityFromRpyRates(const Eigen::Vector3d& rpy);

/// d(omega_a)/dt for given rates and accelerations of rpy [rad/s^2].
[[nodiscard]] Eigen::Vector3d AngularAccelerationFromRpy(const Eigen::Vector3d& rpy,
                                                         const Eigen::Vector3d& rates,
                                                         const Eigen::Vector3d& accelerations);

}  // namespace calibrato
