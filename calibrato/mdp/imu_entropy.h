#pragma once

#include <cstddef>

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

/// What stood in its place in the original implementation (Mistake::kDurationEntropy): 0.1 of the
/// summed "entropy" of four quaternion components in a buffer of at most 2000 samples, where each
/// value is a bin of its own and 2.73 stands for e: 0.4 ln N / ln 2.73. It is 2.75 after 1000
/// samples, 3.03 after 2000, and the same for any motion.
[[nodiscard]] double OriginalImuEntropy(size_t num_samples);

}  // namespace calibrato
