#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/calibration/imu_noise.h"

namespace calibrato {

/// The noise of one IMU of a log.
struct NamedNoise {
  std::string name;  ///< "imu0"
  ImuNoiseEstimate estimate;
};

/// What `calibrato noise --json` prints, and what its page is given:
///     {"kind": "noise", "warnings": [..],
///      "imus": [{"name",
///                "gyro": {"rate_hz", "duration_s", "noise_density", "random_walk",
///                         each with "_relative_sigma" and "_is_upper_bound" behind its name,
///                         "axes": [{"noise_density", "random_walk", "bias_instability",
///                                   "tau_s": [..], "deviation": [..], "relative_sigma": [..]}]},
///                "accel": likewise}]}
/// in the units of imu.yaml.
[[nodiscard]] Value NoiseResult(const std::vector<NamedNoise>& imus);

/// In plain text, for the terminal.
[[nodiscard]] std::string NoiseText(const std::vector<NamedNoise>& imus);

}  // namespace calibrato
