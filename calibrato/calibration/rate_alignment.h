#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace calibrato {

/// Mean angular rate of a sensor over an interval, in its own frame [rad/s].
struct RateInterval {
  double begin_s = 0.0;
  double end_s = 0.0;  ///< > begin_s
  Eigen::Vector3d rate;
};

/// A gyroscope's reading at a time on its own clock.
struct RateSample {
  double time_s = 0.0;
  Eigen::Vector3d rate;
};

/// How a sensor c that turned as `intervals` say is mounted to a gyroscope i.
struct RateAlignment {
  double time_offset_s = 0.0;  ///< t_i = t_c + time_offset [s]
  Eigen::Matrix3d R_c_i;
  Eigen::Vector3d gyro_bias;  ///< [rad/s]
  double correlation = 0.0;   ///< Of R_c_i (omega_i - bias) with the sensor's rates, up to 1.
};

/// From fewer nothing is found.
inline constexpr size_t kMinRateIntervals = 5;

/// The time offset within +- max_offset_s at which the rates agree best when turned by the best
/// rotation: for each offset rotation and bias in closed form (Wahba's problem on rates from which
/// their mean is taken; Kabsch 1976), the offset by search and a parabola through the best three.
/// Intervals that the gyroscope did not record whole are left out.
/// @return nothing with fewer than kMinRateIntervals at every offset, or without any rotation.
[[nodiscard]] std::optional<RateAlignment> AlignRates(const std::vector<RateInterval>& intervals,
                                                      const std::vector<RateSample>& gyro,
                                                      double max_offset_s);

/// How many intervals the gyroscope recorded whole at that time offset, of those that AlignRates
/// looks at, at which they are most.
[[nodiscard]] size_t MostCoveredIntervals(const std::vector<RateInterval>& intervals,
                                          const std::vector<RateSample>& gyro, double max_offset_s);

}  // namespace calibrato
