#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

/// Standard gravity [m/s^2]. A level IMU at rest reads f = (0, 0, +9.80665).
inline constexpr double kStandardGravity = 9.80665;

/// Noise of an IMU as continuous-time densities, with Kalibr's meaning and names. The standard
/// deviation of one sample is density * sqrt(rate).
///
/// The defaults are the paper's IMU (Table 2), whose figures are per sample at 200 Hz: 0.004 m/s^2
/// and 3.394e-4 rad/s; its drifts (0.006 m/s^2 and 3.8785e-5 rad/s, Gauss-Markov with 3600 s) as
/// random walks are drift * sqrt(2 / 3600 s).
struct ImuNoise {
  double rate_hz = 200.0;
  double accel_noise_density = 2.83e-4;  ///< [m/s^2/sqrt(Hz)]
  double accel_random_walk = 1.41e-4;    ///< [m/s^3/sqrt(Hz)]
  double gyro_noise_density = 2.40e-5;   ///< [rad/s/sqrt(Hz)]
  double gyro_random_walk = 9.1e-7;      ///< [rad/s^2/sqrt(Hz)]
};

/// Kalibr's imu.yaml. @throws InputError unless all are positive. Unknown keys are appended to
/// warnings (may be null).
[[nodiscard]] ImuNoise ImuNoiseFromValue(const Value& value, std::vector<std::string>* warnings);
[[nodiscard]] Value ToValue(const ImuNoise& noise);

}  // namespace calibrato
