#include "calibrato/mdp/imu_entropy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace calibrato {
namespace {

constexpr int kNumBins = 64;
constexpr double kGyroRange = 2.0;    // [rad/s]
constexpr double kAccelRange = 15.0;  // [m/s^2]

double ChannelEntropy(const std::vector<VectorSample>& samples, int axis, double range) {
  std::array<int, kNumBins> counts{};
  for (const VectorSample& sample : samples) {
    const double place = (sample.value(axis) + range) / (2.0 * range) * kNumBins;
    ++counts[static_cast<size_t>(std::clamp(std::floor(place), 0.0, kNumBins - 1.0))];
  }
  double entropy = 0.0;
  for (const int count : counts) {
    if (count == 0) continue;
    const double p = static_cast<double>(count) / static_cast<double>(samples.size());
    entropy -= p * std::log(p);
  }
  return entropy;
}

}  // namespace

double ImuEntropy(const ImuStream& stream) {
  double entropy = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    entropy += ChannelEntropy(stream.gyro, axis, kGyroRange);
    entropy += ChannelEntropy(stream.accel, axis, kAccelRange);
  }
  return entropy;
}

double OriginalImuEntropy(size_t num_samples) {
  constexpr size_t kBuffer = 2000;
  if (num_samples == 0) return 0.0;
  return 0.4 * std::log(static_cast<double>(std::min(num_samples, kBuffer))) / std::log(2.73);
}

}  // namespace calibrato
