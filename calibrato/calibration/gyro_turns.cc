#include "calibrato/calibration/gyro_turns.h"

#include <algorithm>

#include "calibrato/geometry/so3.h"

namespace calibrato {

GyroTurns::GyroTurns(const std::vector<RateSample>& gyro, const Eigen::Vector3d& gyro_bias) {
  turns_.reserve(gyro.size());
  for (const RateSample& sample : gyro) {
    const Eigen::Vector3d rate = sample.rate - gyro_bias;
    if (turns_.empty()) {
      turns_.push_back({sample.time_s, Eigen::Matrix3d::Identity(), rate});
      continue;
    }
    const Turn& last = turns_.back();
    const double duration = sample.time_s - last.time_s;
    turns_.push_back({sample.time_s, last.R * ExpSo3(0.5 * duration * (last.rate + rate)), rate});
  }
}

Eigen::Matrix3d GyroTurns::At(double t_s) const {
  const auto after = std::partition_point(turns_.begin(), turns_.end(),
                                          [&](const Turn& turn) { return turn.time_s <= t_s; });
  const Turn& before = after == turns_.begin() ? *after : *(after - 1);
  return before.R * ExpSo3((t_s - before.time_s) * before.rate);
}

}  // namespace calibrato
