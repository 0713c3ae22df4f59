#include "calibrato/calibration/allan_deviation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "calibrato/base/parallel.h"

namespace calibrato {
namespace {

// Sums of the first k samples, less k means, so that what is added up does not grow.
std::vector<double> RunningSums(const std::vector<double>& series) {
  const double mean =
      std::accumulate(series.begin(), series.end(), 0.0) / static_cast<double>(series.size());
  std::vector<double> sums(series.size() + 1, 0.0);
  for (size_t k = 0; k < series.size(); ++k) sums[k + 1] = sums[k] + (series[k] - mean);
  return sums;
}

AllanPoint PointOf(const std::vector<double>& sums, double period_s, int64_t num_samples) {
  const auto m = static_cast<size_t>(num_samples);
  const size_t num_differences = sums.size() - 2 * m;
  double squares = 0.0;
  for (size_t k = 0; k < num_differences; ++k) {
    const double difference = sums[k + 2 * m] - 2.0 * sums[k + m] + sums[k];
    squares += difference * difference;
  }
  const auto samples = static_cast<double>(num_samples);
  return {samples * period_s,
          std::sqrt(squares / (2.0 * static_cast<double>(num_differences))) / samples, num_samples};
}

}  // namespace

AllanPoint OverlappingAllanDeviationAt(const std::vector<double>& series, double period_s,
                                       int64_t num_samples) {
  assert(num_samples >= 1 && 2 * num_samples <= static_cast<int64_t>(series.size()));
  return PointOf(RunningSums(series), period_s, num_samples);
}

std::vector<AllanPoint> OverlappingAllanDeviation(const std::vector<double>& series,
                                                  double period_s, int per_octave) {
  assert(per_octave >= 1);
  const auto largest = static_cast<int64_t>(series.size() / 4);
  std::vector<int64_t> counts;
  for (int k = 0;; ++k) {
    const int64_t count = std::llround(std::exp2(static_cast<double>(k) / per_octave));
    if (count > largest) break;
    if (counts.empty() || count > counts.back()) counts.push_back(count);
  }
  if (counts.empty()) return {};
  const std::vector<double> sums = RunningSums(series);
  return ParallelMap<AllanPoint>(counts.size(),
                                 [&](size_t k) { return PointOf(sums, period_s, counts[k]); });
}

double AllanDegreesOfFreedom(NoiseSlope slope, int64_t series_size, int64_t num_samples) {
  // In the handbook's words N counts phases, which are one more than the samples.
  const auto n = static_cast<double>(series_size + 1);
  const auto m = static_cast<double>(num_samples);
  double degrees = 0.0;
  switch (slope) {
    case NoiseSlope::kWhite:
      degrees =
          (3.0 * (n - 1.0) / (2.0 * m) - 2.0 * (n - 2.0) / n) * 4.0 * m * m / (4.0 * m * m + 5.0);
      break;
    case NoiseSlope::kFlicker:
      degrees = num_samples == 1 ? 2.0 * (n - 2.0) / (2.3 * n - 4.9) * (n - 2.0)
                                 : 5.0 * n * n / (4.0 * m * (n + 3.0 * m));
      break;
    case NoiseSlope::kWalk:
      degrees = (n - 2.0) / m * ((n - 1.0) * (n - 1.0) - 3.0 * m * (n - 1.0) + 4.0 * m * m) /
                ((n - 3.0) * (n - 3.0));
      break;
  }
  return std::max(1.0, degrees);
}

}  // namespace calibrato
