#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/sensors/imu.h"

namespace calibrato {

/// What a simulated IMU does to the rates and forces it feels, beyond the noise of `ImuNoise`: all
/// off by default. In this order: intrinsics, low-pass, bias and noise, saturation, quantisation,
/// clock.
struct ImuDisturbances {
  ImuIntrinsics intrinsics;
  /// Cut-off of a first-order low-pass in each channel [Hz]; 0: none. It delays slow motions by its
  /// group delay, 1 / (2 pi low_pass_hz).
  double low_pass_hz = 0.0;
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();           ///< At the first sample [rad/s].
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();          ///< At the first sample [m/s^2].
  double gyro_range = std::numeric_limits<double>::infinity();   ///< Saturates at +- this [rad/s].
  double accel_range = std::numeric_limits<double>::infinity();  ///< ... [m/s^2]
  double gyro_resolution = 0.0;   ///< One step of the digital output [rad/s]; 0: infinitely fine.
  double accel_resolution = 0.0;  ///< ... [m/s^2]
  /// Of the IMU's clock against the camera's: t_i = start + offset + (1 + 1e-6 drift) (t_c -
  /// start).
  double clock_drift_ppm = 0.0;
};

/// The optional keys of `imu` in RIG.yaml: `accelerometers` and `gyroscopes` as Kalibr has them
/// (imu_file.h), and
///
///     disturbances: {low_pass_hz, gyro_bias_rad_s: [3], accel_bias_m_s2: [3], gyro_range_rad_s,
///                    accel_range_m_s2, gyro_resolution_rad_s, accel_resolution_m_s2,
///                    clock_drift_ppm}
///
/// @throws InputError with line and key: ranges must be positive, resolutions and the cut-off not
/// negative, the drift within +-10000 ppm. Unknown keys are appended to warnings (may be null).
[[nodiscard]] ImuDisturbances ImuDisturbancesFromValue(const Value& imu,
                                                       std::vector<std::string>* warnings);
/// Adds these keys to `imu`; null stands for a range without end.
void SetImuDisturbances(const ImuDisturbances& disturbances, Value* imu);

}  // namespace calibrato
