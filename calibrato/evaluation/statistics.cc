#include "calibrato/evaluation/statistics.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <limits>
#include <numeric>

namespace calibrato {
namespace {

constexpr int kNumResamples = 2000;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// The 2.5 % and 97.5 % points of a statistic over resamples of n indices.
Interval Bootstrap(size_t n, Rng* rng,
                   const std::function<double(const std::vector<size_t>&)>& statistic) {
  if (n == 0) return {kNan, kNan};
  std::vector<double> draws(kNumResamples);
  std::vector<size_t> indices(n);
  for (double& draw : draws) {
    for (size_t& index : indices) index = rng->UniformIndex(n);
    draw = statistic(indices);
  }
  std::sort(draws.begin(), draws.end());
  return {draws[static_cast<size_t>(0.025 * (kNumResamples - 1))],
          draws[static_cast<size_t>(0.975 * (kNumResamples - 1))]};
}

double Sum(const std::vector<double>& values, const std::vector<size_t>& indices) {
  double sum = 0.0;
  for (const size_t index : indices) sum += values[index];
  return sum;
}

}  // namespace

double Mean(const std::vector<double>& values) {
  if (values.empty()) return kNan;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double Median(std::vector<double> values) {
  if (values.empty()) return kNan;
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

Interval BootstrapMean(const std::vector<double>& values, Rng rng) {
  return Bootstrap(values.size(), &rng, [&](const std::vector<size_t>& indices) {
    return Sum(values, indices) / static_cast<double>(indices.size());
  });
}

Interval BootstrapRatio(const std::vector<double>& numerator,
                        const std::vector<double>& denominator, Rng rng) {
  assert(numerator.size() == denominator.size());
  return Bootstrap(numerator.size(), &rng, [&](const std::vector<size_t>& indices) {
    return Sum(numerator, indices) / Sum(denominator, indices);
  });
}

}  // namespace calibrato
