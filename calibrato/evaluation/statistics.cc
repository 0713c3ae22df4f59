#include "calibrato/evaluation/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "calibrato/calibration/chi_square.h"

namespace calibrato {
namespace {

constexpr int kNumResamples = 2000;
constexpr int kNumPermutations = 4999;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Of the middle 95 %.
Interval Percentiles(std::vector<double> statistics) {
  std::sort(statistics.begin(), statistics.end());
  const auto at = [&](double share) {
    return statistics[static_cast<size_t>(share * static_cast<double>(statistics.size() - 1))];
  };
  return {at(0.025), at(0.975)};
}

std::vector<size_t> DrawWithReplacement(size_t n, Rng& rng) {
  std::vector<size_t> drawn(n);
  for (size_t& index : drawn) index = static_cast<size_t>(rng.UniformIndex(n));
  return drawn;
}

std::vector<size_t> Each(size_t n) {
  std::vector<size_t> each(n);
  std::iota(each.begin(), each.end(), size_t{0});
  return each;
}

/// A rig's figure over these members, as a sum and a count.
struct Total {
  double sum = 0.0;
  int count = 0;
  void Add(const Total& other) {
    sum += other.sum;
    count += other.count;
  }
};

Total OnRig(const Figures& figures, const std::vector<size_t>& members, size_t rig) {
  Total total;
  for (const size_t member : members) {
    const double value = figures[member][rig];
    if (std::isnan(value)) continue;
    total.sum += value;
    ++total.count;
  }
  return total;
}

double MeanOver(const Figures& figures, const std::vector<size_t>& members,
                const std::vector<size_t>& rigs) {
  Total total;
  for (const size_t rig : rigs) total.Add(OnRig(figures, members, rig));
  return total.count == 0 ? kNan : total.sum / total.count;
}

// Each rig counts alike, whatever number of members it failed with.
double RatioOver(const Figures& numerator, const std::vector<size_t>& numerator_members,
                 const Figures& denominator, const std::vector<size_t>& denominator_members,
                 const std::vector<size_t>& rigs) {
  double top = 0.0;
  double bottom = 0.0;
  for (const size_t rig : rigs) {
    const Total a = OnRig(numerator, numerator_members, rig);
    const Total b = OnRig(denominator, denominator_members, rig);
    if (a.count == 0 || b.count == 0) continue;
    top += a.sum / a.count;
    bottom += b.sum / b.count;
  }
  return top / bottom;
}

size_t NumRigs(const Figures& figures) { return figures.empty() ? 0 : figures.front().size(); }

// The value that a chi-square variable exceeds with this probability.
double ChiSquareQuantile(double tail, double degrees) {
  double low = 0.0;
  double high = degrees + 10.0;
  while (ChiSquareTail(high, degrees) > tail) high *= 2.0;
  constexpr int kNumHalvings = 80;
  for (int i = 0; i < kNumHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (ChiSquareTail(middle, degrees) > tail ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double Mean(const std::vector<double>& values) {
  if (values.empty()) return kNan;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double Median(std::vector<double> values) {
  if (values.empty()) return kNan;
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::vector<double> Existing(const Figures& figures) {
  std::vector<double> existing;
  for (const std::vector<double>& member : figures) {
    for (const double value : member) {
      if (!std::isnan(value)) existing.push_back(value);
    }
  }
  return existing;
}

Interval BootstrapMean(const Figures& figures, const Rng& rng) {
  const size_t num_rigs = NumRigs(figures);
  if (num_rigs == 0) return {kNan, kNan};
  Rng draws = rng;
  std::vector<double> means;
  for (int k = 0; k < kNumResamples; ++k) {
    const std::vector<size_t> members = DrawWithReplacement(figures.size(), draws);
    const double mean = MeanOver(figures, members, DrawWithReplacement(num_rigs, draws));
    if (!std::isnan(mean)) means.push_back(mean);
  }
  return means.empty() ? Interval{kNan, kNan} : Percentiles(std::move(means));
}

Interval BootstrapMean(const std::vector<double>& values, const Rng& rng) {
  return BootstrapMean(Figures{values}, rng);
}

double PairedRatio(const Figures& numerator, const Figures& denominator) {
  assert(NumRigs(numerator) == NumRigs(denominator));
  return RatioOver(numerator, Each(numerator.size()), denominator, Each(denominator.size()),
                   Each(NumRigs(numerator)));
}

Interval BootstrapRatio(const Figures& numerator, const Figures& denominator, const Rng& rng) {
  assert(NumRigs(numerator) == NumRigs(denominator));
  const size_t num_rigs = NumRigs(numerator);
  if (num_rigs == 0) return {kNan, kNan};
  // What is compared with itself has the ratio 1, whichever of its members are drawn.
  const bool is_itself = &numerator == &denominator;
  Rng draws = rng;
  std::vector<double> ratios;
  for (int k = 0; k < kNumResamples; ++k) {
    const std::vector<size_t> above = DrawWithReplacement(numerator.size(), draws);
    const std::vector<size_t> below =
        is_itself ? above : DrawWithReplacement(denominator.size(), draws);
    const double ratio =
        RatioOver(numerator, above, denominator, below, DrawWithReplacement(num_rigs, draws));
    if (!std::isnan(ratio)) ratios.push_back(ratio);
  }
  return ratios.empty() ? Interval{kNan, kNan} : Percentiles(std::move(ratios));
}

Interval BootstrapRatio(const std::vector<double>& numerator,
                        const std::vector<double>& denominator, const Rng& rng) {
  return BootstrapRatio(Figures{numerator}, Figures{denominator}, rng);
}

double PairedPermutationProbability(const Figures& numerator, const Figures& denominator, Rng rng) {
  assert(NumRigs(numerator) == NumRigs(denominator));
  std::vector<std::pair<double, double>> pairs;
  for (size_t rig = 0; rig < NumRigs(numerator); ++rig) {
    const Total a = OnRig(numerator, Each(numerator.size()), rig);
    const Total b = OnRig(denominator, Each(denominator.size()), rig);
    if (a.count > 0 && b.count > 0) pairs.emplace_back(a.sum / a.count, b.sum / b.count);
  }
  if (pairs.size() < 2) return kNan;
  const auto distance = [&](auto swaps) {
    double top = 0.0;
    double bottom = 0.0;
    for (const auto& [a, b] : pairs) {
      const bool is_swapped = swaps();
      top += is_swapped ? b : a;
      bottom += is_swapped ? a : b;
    }
    return std::abs(std::log(top / bottom));
  };
  // Rounding must not tell a permutation that changes nothing from the sample itself.
  constexpr double kTolerance = 1e-12;
  const double observed = distance([] { return false; });
  int as_far = 1;
  for (int k = 0; k < kNumPermutations; ++k) {
    uint64_t bits = 0;
    int num_bits = 0;
    const double permuted = distance([&] {
      if (num_bits == 0) {
        bits = rng.NextBits();
        num_bits = 64;
      }
      const bool bit = (bits & 1U) != 0;
      bits >>= 1U;
      --num_bits;
      return bit;
    });
    if (permuted >= observed - kTolerance) ++as_far;
  }
  return as_far / static_cast<double>(kNumPermutations + 1);
}

std::vector<double> HolmAdjusted(const std::vector<double>& probabilities) {
  std::vector<size_t> order;
  for (size_t i = 0; i < probabilities.size(); ++i) {
    if (!std::isnan(probabilities[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return probabilities[a] < probabilities[b]; });
  std::vector<double> adjusted(probabilities.size(), kNan);
  double largest = 0.0;
  for (size_t k = 0; k < order.size(); ++k) {
    const auto num_left = static_cast<double>(order.size() - k);
    largest = std::max(largest, std::min(1.0, num_left * probabilities[order[k]]));
    adjusted[order[k]] = largest;
  }
  return adjusted;
}

ConsistencyTest TestConsistency(const std::vector<double>& nees, int dimension) {
  if (nees.empty()) return {kNan, {kNan, kNan}, kNan};
  const auto n = static_cast<double>(nees.size());
  const double degrees = n * dimension;
  const double sum = std::accumulate(nees.begin(), nees.end(), 0.0);
  const double above = ChiSquareTail(sum, degrees);
  return {sum / n,
          {ChiSquareQuantile(0.975, degrees) / n, ChiSquareQuantile(0.025, degrees) / n},
          2.0 * std::min(above, 1.0 - above)};
}

}  // namespace calibrato
