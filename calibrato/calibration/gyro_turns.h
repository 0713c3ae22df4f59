#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/calibration/rate_alignment.h"

namespace calibrato {

/// How a rig turned, by its gyroscope: rates integrated from the first sample on, constant between
/// two samples at the mean of both. Drifts as the bias is off; good over parts of a second.
class GyroTurns {
 public:
  /// @param gyro  In order of time; at least one.
  GyroTurns(const std::vector<RateSample>& gyro, const Eigen::Vector3d& gyro_bias);

  /// R_i0_it, from the frame at t_s to the one at the first sample; rates beyond the ends are those
  /// at the ends.
  [[nodiscard]] Eigen::Matrix3d At(double t_s) const;

 private:
  struct Turn {
    double time_s;
    Eigen::Matrix3d R;
    Eigen::Vector3d rate;
  };
  std::vector<Turn> turns_;
};

}  // namespace calibrato
