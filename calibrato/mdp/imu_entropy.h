#pragma once

#include "calibrato/sensors/imu.h"

namespace calibrato {

/// Entropy of what an IMU recorded, in the paper's words "of IMU measurement data in 6 dimensions":
/// the sum over the six channels of the entropy of a histogram of 64 equal bins over +-2 rad/s and
/// +-15 m/s^2 [nats]; what lies outside counts in the outermost bins. Zero where nothing was
/// recorded.
///
/// The ranges are fixed, so that it measures how evenly rates and forces are spread and not how
/// long the recording is: that was the original implementation's mistake (docs/differences.md).
[[nodiscard]] double ImuEntropy(const ImuStream& stream);

}  // namespace calibrato
