#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "calibrato/sensors/imu.h"

namespace calibrato {

/// What can be wrong with the samples of one sensor, counted. The order of the samples is that of
/// the file.
struct StreamDefects {
  size_t num_samples = 0;
  size_t num_not_finite = 0;     ///< Samples with NaN or an infinity.
  size_t num_out_of_order = 0;   ///< Stamps earlier than the one before them.
  size_t num_duplicates = 0;     ///< Samples whose stamp an earlier one has.
  double median_period_s = 0.0;  ///< Between neighbours in time; 0 with fewer than two.
  size_t num_gaps = 0;           ///< Periods longer than three medians ...
  double longest_gap_s = 0.0;    ///< ... the longest of them [s] ...
  Time longest_gap_begin;        ///< ... and where it begins.
  /// Of each axis: samples that stand at its highest or lowest value, if that looks like the end of
  /// the sensor's range: at least five, five times as many as at the value next to it, and not the
  /// most of all; else 0.
  std::array<size_t, 3> num_saturated{};
  std::array<double, 3> saturated_at{};  ///< The larger in size of the two ends that were found.
  std::array<bool, 3> is_constant{};     ///< Every sample is the same, of at least five.
};
[[nodiscard]] StreamDefects FindDefects(const std::vector<VectorSample>& samples);

/// The samples as an estimator wants them: finite, ascending, of twins the one that came first, and
/// none of which an axis stands at the end of the sensor's range.
[[nodiscard]] std::vector<VectorSample> Mended(const std::vector<VectorSample>& samples);
[[nodiscard]] ImuStream Mended(const ImuStream& stream);

}  // namespace calibrato
