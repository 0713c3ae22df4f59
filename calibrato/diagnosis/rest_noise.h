#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/diagnosis/finding.h"
#include "calibrato/sensors/imu.h"

namespace calibrato {

/// White noise of an IMU, from a stretch of its recording during which it lay still.
struct RestNoise {
  Time begin;
  double duration_s = 0.0;           ///< At least 1 s.
  double gyro_noise_density = 0.0;   ///< Root mean square of the axes [rad/s/sqrt(Hz)].
  double accel_noise_density = 0.0;  ///< [m/s^2/sqrt(Hz)]
};

/// The longest rest. At rest the mean of n samples scatters by their standard deviation over
/// sqrt(n), as of white noise; a hand that holds still trembles slowly, by much more. So spans of a
/// tenth of a second are joined as long as their means, of all six channels, stay within the limits
/// of noise or of one milliradian per second and one hundredth of m/s^2.
///
/// The density is that of the differences of neighbouring samples: stddev / sqrt(2 rate).
/// @param stream  Finite, ascending.
/// @return nothing where it never rested for a second, or has fewer than five samples in a span.
[[nodiscard]] std::optional<RestNoise> NoiseAtRest(const ImuStream& stream);

/// warn: noise at rest of more than three times what is stated; it is more still when the rig
/// moves.
[[nodiscard]] std::vector<Finding> FindingsOnRestNoise(const std::string& imu,
                                                       const RestNoise& found,
                                                       const ImuNoise& stated);

}  // namespace calibrato
