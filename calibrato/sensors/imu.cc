#include "calibrato/sensors/imu.h"

#include <Eigen/Geometry>

namespace calibrato {
namespace {

// What is added to the acceleration at an arm r from the origin, in frame i.
Eigen::Vector3d LeverAcceleration(const ImuMotion& motion, const Eigen::Vector3d& r_i) {
  return motion.alpha_i.cross(r_i) + motion.omega_i.cross(motion.omega_i.cross(r_i));
}

}  // namespace

ImuMotion MotionOfFrame(const ImuMotion& motion_i, const Rigid3& T_i_j) {
  return {
      .R_w_i = motion_i.R_w_i * T_i_j.R,
      .omega_i = T_i_j.R.transpose() * motion_i.omega_i,
      .alpha_i = T_i_j.R.transpose() * motion_i.alpha_i,
      .accel_w = motion_i.accel_w + motion_i.R_w_i * LeverAcceleration(motion_i, T_i_j.t),
  };
}

Eigen::Vector3d SpecificForce(const ImuMotion& motion, const Eigen::Vector3d& gravity_w) {
  return motion.R_w_i.transpose() * (motion.accel_w - gravity_w);
}

Eigen::Vector3d PredictGyro(const ImuMotion& motion, const Eigen::Vector3d& gravity_w,
                            const ImuIntrinsics& intrinsics, const Eigen::Vector3d& bias) {
  return intrinsics.M_gyro * (intrinsics.R_gyro_i * motion.omega_i) +
         intrinsics.g_sensitivity * (intrinsics.R_gyro_i * SpecificForce(motion, gravity_w)) + bias;
}

Eigen::Vector3d PredictAccel(const ImuMotion& motion, const Eigen::Vector3d& gravity_w,
                             const ImuIntrinsics& intrinsics, const Eigen::Vector3d& bias) {
  Eigen::Vector3d force_i = SpecificForce(motion, gravity_w);
  for (int k = 0; k < 3; ++k) {
    force_i(k) += LeverAcceleration(motion, intrinsics.lever_arms_i.col(k))(k);
  }
  return intrinsics.M_accel * force_i + bias;
}

}  // namespace calibrato
