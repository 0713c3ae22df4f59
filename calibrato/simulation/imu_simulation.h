#pragma once

#include <functional>

#include "calibrato/base/rng.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/imu_disturbances.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// How the IMU of the rig moves while its carrier makes the motion: rates and accelerations from
/// the derivatives of the loops' harmonics and of the time law, in closed form. So the truth shares
/// no spline with any estimator.
///
/// At fidelity `fast` the controlled frame follows the loops on the arm too: camera and IMU see the
/// same path, and the joints' interpolation between way-points stays out of both.
/// @param t_s  Since the motion began [s]; before and after it the rig is at rest.
[[nodiscard]] ImuMotion ImuMotionAt(const Rig& rig, const TimedMotion& motion, double t_s);
/// ... on any path.
[[nodiscard]] ImuMotion ImuMotionAt(const Rig& rig, const CarrierPath& path, double t_s);

/// What an IMU recorded, and the biases that it had.
struct SimulatedImu {
  ImuStream stream;                 ///< Gyroscope and accelerometer with the same stamps.
  Eigen::Vector3d mean_gyro_bias;   ///< Over the recording [rad/s].
  Eigen::Vector3d mean_accel_bias;  ///< Over the recording [m/s^2].
};

/// An IMU on any path. Noise is white with the stated densities, biases are random walks that begin
/// at those of the disturbances. Numbers are drawn alike for every setting, so that a disturbance
/// switched on changes no draw.
///
/// The low-pass is exact for what changes linearly between fifths of the sampling period, and
/// begins settled.
/// @param motion_at  For t_s in [0, duration_s), in order of time [s].
/// @param gravity_w  [m/s^2]
/// @param start  The IMU's clock at t_s = 0, where the first sample is taken; the next ones follow
/// 1 / noise.rate_hz apart on this clock, as long as the path lasts.
[[nodiscard]] SimulatedImu SimulateImu(const std::function<ImuMotion(double t_s)>& motion_at,
                                       double duration_s, const Eigen::Vector3d& gravity_w,
                                       const ImuNoise& noise, const ImuDisturbances& disturbances,
                                       Time start, Rng& rng);

/// The IMU of the rig during the motion, in standard gravity.
/// @param start  The camera's clock when the motion begins, as for SimulateFrames.
[[nodiscard]] SimulatedImu SimulateImu(const Rig& rig, const TimedMotion& motion, Time start,
                                       Rng& rng);
/// ... on any path.
[[nodiscard]] SimulatedImu SimulateImu(const Rig& rig, const CarrierPath& path, Time start,
                                       Rng& rng);

}  // namespace calibrato
