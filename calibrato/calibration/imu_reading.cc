#include "calibrato/calibration/imu_reading.h"

#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Columns of J_intrinsics.
constexpr int kMAccel = 0;
constexpr int kMGyro = 6;
constexpr int kRGyro = 12;
constexpr int kGSensitivity = 15;
constexpr int kLeverArms = 24;

// d(M v) to the lower triangle of M, row by row.
template <typename Derived>
void SetLowerTriangle(const Vector3d& v, Eigen::MatrixBase<Derived>&& J) {
  int k = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column <= row; ++column) J(row, k++) = v(column);
  }
}

}  // namespace

void LineariseGyro(const ImuMotion& motion, const Vector3d& gravity_g,
                   const ImuIntrinsics& intrinsics, bool with_intrinsics, ImuReading* reading) {
  const Vector3d pull_g = motion.accel_w - gravity_g;
  const Matrix3d R_i_g = motion.R_w_i.transpose();
  const Vector3d turned_omega = intrinsics.R_gyro_i * motion.omega_i;
  const Vector3d turned_force = intrinsics.R_gyro_i * (R_i_g * pull_g);
  const Matrix3d J_force = intrinsics.g_sensitivity * intrinsics.R_gyro_i * R_i_g;
  reading->value = intrinsics.M_gyro * turned_omega + intrinsics.g_sensitivity * turned_force;
  reading->J_motion << J_force * Hat(pull_g), intrinsics.M_gyro * intrinsics.R_gyro_i,
      Matrix3d::Zero(), J_force;
  reading->J_gravity = -J_force;
  if (!with_intrinsics) return;
  auto& J = reading->J_intrinsics;
  J.setZero();
  SetLowerTriangle(turned_omega, J.middleCols<6>(kMGyro));
  J.middleCols<3>(kRGyro) =
      -(intrinsics.M_gyro * Hat(turned_omega) + intrinsics.g_sensitivity * Hat(turned_force));
  for (int row = 0; row < 3; ++row) {
    J.block<1, 3>(row, kGSensitivity + 3 * row) = turned_force.transpose();
  }
}

void LineariseAccel(const ImuMotion& motion, const Vector3d& gravity_g,
                    const ImuIntrinsics& intrinsics, bool with_intrinsics, ImuReading* reading) {
  const Vector3d pull_g = motion.accel_w - gravity_g;
  const Matrix3d R_i_g = motion.R_w_i.transpose();
  const Vector3d& omega = motion.omega_i;
  // What a point at r feels beyond the origin: (alpha x + omega x omega x) r.
  const Matrix3d lever = Hat(motion.alpha_i) + Hat(omega) * Hat(omega);
  Vector3d felt = R_i_g * pull_g;
  Matrix3d J_omega;
  Matrix3d J_alpha;
  for (int k = 0; k < 3; ++k) {
    const Vector3d r = intrinsics.lever_arms_i.col(k);
    felt(k) += lever.row(k).dot(r);
    J_omega.row(k) = -(Hat(omega.cross(r)) + Hat(omega) * Hat(r)).row(k);
    J_alpha.row(k) = -Hat(r).row(k);
  }
  const Matrix3d& M = intrinsics.M_accel;
  const Matrix3d J_force = M * R_i_g;
  reading->value = M * felt;
  reading->J_motion << J_force * Hat(pull_g), M * J_omega, M * J_alpha, J_force;
  reading->J_gravity = -J_force;
  if (!with_intrinsics) return;
  auto& J = reading->J_intrinsics;
  J.setZero();
  SetLowerTriangle(felt, J.middleCols<6>(kMAccel));
  for (int k = 1; k < 3; ++k) {
    J.middleCols<3>(kLeverArms + 3 * (k - 1)) = M.col(k) * lever.row(k);
  }
}

FrameMotionJacobians JacobiansMotionOfFrame(const ImuMotion& motion_i, const Rigid3& T_i_j) {
  const Matrix3d& R_g_i = motion_i.R_w_i;
  const Matrix3d R_j_i = T_i_j.R.transpose();
  const Vector3d& omega = motion_i.omega_i;
  const Vector3d& r = T_i_j.t;
  const Matrix3d lever = Hat(motion_i.alpha_i) + Hat(omega) * Hat(omega);
  FrameMotionJacobians J;
  J.J_motion.setZero();
  J.J_motion.block<3, 3>(0, 0).setIdentity();
  J.J_motion.block<3, 3>(3, 3) = R_j_i;
  J.J_motion.block<3, 3>(6, 6) = R_j_i;
  J.J_motion.block<3, 3>(9, 0) = -Hat(R_g_i * (lever * r));
  J.J_motion.block<3, 3>(9, 3) = -R_g_i * (Hat(omega.cross(r)) + Hat(omega) * Hat(r));
  J.J_motion.block<3, 3>(9, 6) = -R_g_i * Hat(r);
  J.J_motion.block<3, 3>(9, 9).setIdentity();
  J.J_pose.setZero();
  J.J_pose.block<3, 3>(0, 0) = R_g_i;
  J.J_pose.block<3, 3>(3, 0) = R_j_i * Hat(omega);
  J.J_pose.block<3, 3>(6, 0) = R_j_i * Hat(motion_i.alpha_i);
  J.J_pose.block<3, 3>(9, 3) = R_g_i * lever;
  return J;
}

}  // namespace calibrato
