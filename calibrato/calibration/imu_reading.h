#pragma once

#include <Eigen/Core>

#include "calibrato/sensors/imu.h"

namespace calibrato {

/// How frame i's motion is perturbed: [dtheta (R_g_i = Exp(dtheta) R^), d omega_i, d alpha_i,
/// d accel_g], 12 numbers.
using JacobianMotion = Eigen::Matrix<double, 3, 12>;

/// A reading of one sensor, with its derivatives. The bias adds: its derivative is the identity.
struct ImuReading {
  Eigen::Vector3d value;
  JacobianMotion J_motion;
  Eigen::Matrix3d J_gravity;
  /// To the intrinsics in the order of CameraImuLayout (M_accel, M_gyro, R_gyro_i, g_sensitivity,
  /// lever arms of y and z).
  Eigen::Matrix<double, 3, 30> J_intrinsics;
};

/// PredictGyro and PredictAccel (sensors/imu.h) without bias, with Jacobians. World frame is g.
/// @param with_intrinsics  Else J_intrinsics is left as it was.
void LineariseGyro(const ImuMotion& motion, const Eigen::Vector3d& gravity_g,
                   const ImuIntrinsics& intrinsics, bool with_intrinsics, ImuReading* reading);
void LineariseAccel(const ImuMotion& motion, const Eigen::Vector3d& gravity_g,
                    const ImuIntrinsics& intrinsics, bool with_intrinsics, ImuReading* reading);

/// How the motion of frame j changes with that of frame i on the same body, and with T_i_j: rows
/// and columns as in JacobianMotion. @param motion_i  See MotionOfFrame.
struct FrameMotionJacobians {
  Eigen::Matrix<double, 12, 12> J_motion;
  Eigen::Matrix<double, 12, 6> J_pose;
};
[[nodiscard]] FrameMotionJacobians JacobiansMotionOfFrame(const ImuMotion& motion_i,
                                                          const Rigid3& T_i_j);

}  // namespace calibrato
