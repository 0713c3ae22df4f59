#include "calibrato/diagnosis/stream_timing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibrato/diagnosis/upper_median.h"

namespace calibrato {
namespace {

constexpr double kGapPeriods = 3.0;
constexpr double kPause = 10.0;        // [s]
constexpr double kManyMissing = 0.05;  // Of all that were due.
constexpr double kLargeJitter = 0.2;   // Of a period.
constexpr double kBurst = 0.5;         // Of the mean period.
constexpr size_t kMinStamps = 20;      // To speak of how they are spread.
constexpr double kStepPeriods = 5.0;   // A clock that is set moves by more than jitter does.
constexpr size_t kStampsOfAClock = 5;  // In order behind the step: it is no single wrong stamp.

// A stamp before which the file's order goes back, and behind which it goes on from there.
bool IsStepBack(const std::vector<Time>& stamps, size_t k, double period_s) {
  if ((stamps[k - 1] - stamps[k]).seconds() <= kStepPeriods * period_s) return false;
  if (k + kStampsOfAClock > stamps.size()) return false;
  // One stamp that is too late goes back too, to where it should have been.
  const bool came_too_far =
      k > 1 && (stamps[k - 1] - stamps[k - 2]).seconds() > kStepPeriods * period_s;
  if (came_too_far) return false;
  for (size_t i = k + 1; i < k + kStampsOfAClock; ++i) {
    if (stamps[i] < stamps[i - 1] || stamps[k - 1] <= stamps[i]) return false;
  }
  return true;
}

}  // namespace

StreamTiming TimingOf(const std::vector<Time>& stamps) {
  StreamTiming timing;
  timing.num_stamps = stamps.size();
  if (stamps.size() < 2) return timing;
  std::vector<Time> sorted = stamps;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  timing.duration_s = (sorted.back() - sorted.front()).seconds();
  std::vector<double> periods_s;
  for (size_t k = 1; k < sorted.size(); ++k) {
    periods_s.push_back((sorted[k] - sorted[k - 1]).seconds());
  }
  timing.median_period_s = UpperMedian(periods_s);
  if (!(timing.median_period_s > 0.0)) return timing;

  double sum = 0.0;
  double sum_of_squares = 0.0;
  size_t num_short = 0;
  const double mean_period_s = timing.duration_s / static_cast<double>(periods_s.size());
  for (size_t k = 0; k < periods_s.size(); ++k) {
    const double multiple = std::max(1.0, std::round(periods_s[k] / timing.median_period_s));
    const double rest = periods_s[k] - multiple * timing.median_period_s;
    sum += rest;
    sum_of_squares += rest * rest;
    timing.num_missing += static_cast<size_t>(multiple) - 1;
    if (periods_s[k] > kPause) timing.num_missing_in_pauses += static_cast<size_t>(multiple) - 1;
    if (periods_s[k] < kBurst * mean_period_s) ++num_short;
    if (!(periods_s[k] > kGapPeriods * timing.median_period_s)) continue;
    ++timing.num_gaps;
    if (periods_s[k] <= timing.longest_gap_s) continue;
    timing.longest_gap_s = periods_s[k];
    timing.longest_gap_begin = sorted[k];
  }
  const auto n = static_cast<double>(periods_s.size());
  timing.jitter_s =
      std::sqrt(std::max(0.0, sum_of_squares / n - (sum / n) * (sum / n))) / std::numbers::sqrt2;
  // A single pause makes the mean long, and no burst.
  timing.comes_in_bursts = 2 * num_short > periods_s.size() && 20 * timing.num_gaps > num_short;

  for (size_t k = 1; k < stamps.size(); ++k) {
    if (!IsStepBack(stamps, k, timing.median_period_s)) continue;
    timing.steps_back.push_back({stamps[k - 1], (stamps[k - 1] - stamps[k]).seconds()});
  }
  return timing;
}

std::vector<Time> StampsOf(const std::vector<VectorSample>& samples) {
  std::vector<Time> stamps;
  stamps.reserve(samples.size());
  for (const VectorSample& sample : samples) stamps.push_back(sample.stamp);
  return stamps;
}

std::vector<Finding> FindingsOnTiming(const std::string& name, const StreamTiming& timing) {
  std::vector<Finding> findings;
  for (const StreamTiming::StepBack& step : timing.steps_back) {
    findings.push_back(
        {Severity::kFail,
         name + Format(": the clock was set back by %.3f s after the stamp %lld", step.step_s,
                       static_cast<long long>(step.before.nanoseconds())),
         "stamp by a clock that is never set (a monotonic one), and record again; or calibrate "
         "what "
         "lies before and after on its own"});
  }
  if (timing.num_stamps < kMinStamps) return findings;
  if (timing.comes_in_bursts) {
    findings.push_back({Severity::kWarn,
                        name + ": its stamps come in bursts: most lie closer together than half of "
                               "the mean period",
                        "take stamps when the sensor measures, not when a packet arrives"});
  } else if (timing.jitter_s > kLargeJitter * timing.median_period_s) {
    findings.push_back(
        {Severity::kWarn,
         name + Format(": its stamps jitter by %.2g ms, %.0f %% of the period",
                       1e3 * timing.jitter_s, 100.0 * timing.jitter_s / timing.median_period_s),
         "take stamps when the sensor measures, not when a message arrives"});
  }
  return findings;
}

std::vector<Finding> FindingsOnMissingImages(const std::string& name, const StreamTiming& timing) {
  const size_t num_due = timing.num_stamps + timing.num_missing;
  const bool are_many =
      static_cast<double>(timing.num_missing) > kManyMissing * static_cast<double>(num_due);
  if (timing.num_gaps == 0) {
    if (!are_many || timing.num_stamps < kMinStamps) return {};
    return {{Severity::kWarn,
             name + Format(": about %zu of %zu images are missing, here and there",
                           timing.num_missing, num_due),
             "record to a faster disk, at a lower rate, or in grey"}};
  }
  return {{Severity::kWarn,
           name + Format(": about %zu images are missing; the longest gap is %.2f s, after the "
                         "stamp %lld",
                         timing.num_missing, timing.longest_gap_s,
                         static_cast<long long>(timing.longest_gap_begin.nanoseconds())),
           "record to a faster disk, at a lower rate, or in grey"}};
}

}  // namespace calibrato
