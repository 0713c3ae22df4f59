#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/diagnosis/finding.h"
#include "calibrato/sensors/imu.h"

namespace calibrato {

/// How evenly a sensor's stamps follow each other.
///
/// Periods are those between neighbours in time. One that is about m medians long (m = round(period
/// / median) > 1) has m - 1 measurements missing in it.
struct StreamTiming {
  size_t num_stamps = 0;
  double duration_s = 0.0;           ///< From the first to the last [s].
  double median_period_s = 0.0;      ///< 0 with fewer than two stamps [s].
  size_t num_missing = 0;            ///< By the periods that are too long ...
  size_t num_missing_in_pauses = 0;  ///< ... those of more than 10 s among them: nothing was
                                     ///< recorded.
  size_t num_gaps = 0;               ///< Periods of more than three medians ...
  double longest_gap_s = 0.0;        ///< ... the longest of them [s] ...
  Time longest_gap_begin;            ///< ... and the stamp before it.
  /// Of one stamp about the time at which it is due [s]: the standard deviation of the periods over
  /// sqrt(2), those of many medians taken modulo the median.
  double jitter_s = 0.0;
  /// Most periods are less than half of the mean one: measurements were stamped in bursts, when a
  /// packet arrived.
  bool comes_in_bursts = false;
  /// Where stamps go back, in the order of the file, and go on from there: the clock was set.
  struct StepBack {
    Time before;
    double step_s = 0.0;  ///< > 0 [s]
  };
  std::vector<StepBack> steps_back;
};

/// @param stamps  In the order of the file.
[[nodiscard]] StreamTiming TimingOf(const std::vector<Time>& stamps);

[[nodiscard]] std::vector<Time> StampsOf(const std::vector<VectorSample>& samples);

/// warn: jitter above a fifth of the period, bursts; fail: a clock that was set back.
/// @param name  "imu0 gyroscope": how findings begin.
[[nodiscard]] std::vector<Finding> FindingsOnTiming(const std::string& name,
                                                    const StreamTiming& timing);

/// warn: images that are missing, since their stamps are too far apart: a gap, or more than a
/// twentieth of all.
[[nodiscard]] std::vector<Finding> FindingsOnMissingImages(const std::string& name,
                                                           const StreamTiming& timing);

}  // namespace calibrato
