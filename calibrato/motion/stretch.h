#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "calibrato/motion/time_law.h"

namespace calibrato {

/// The largest value of a function of time over a loop: at 500 instants at least, those where the
/// law's pieces meet among them, and where they come within 3 % of the largest, at 16 more between
/// two of them.
/// @param kinks_s  More instants, where the function has kinks besides.
/// @param floor  The result is no smaller.
template <typename Function>
double LargestDuring(const TimeLaw& law, const std::vector<double>& kinks_s, double floor,
                     const Function& function) {
  constexpr size_t kMinInstants = 500;
  constexpr int kNumBetween = 16;
  constexpr double kNear = 0.97;
  const size_t num_pieces = law.control_points.empty() ? 1 : law.control_points.size() - 3;
  const size_t num_instants = num_pieces * ((kMinInstants + num_pieces - 1) / num_pieces);
  const double step_s = law.duration_s / static_cast<double>(num_instants);
  std::vector<double> values;
  values.reserve(num_instants + 1);
  double largest = floor;
  for (const double t_s : kinks_s) largest = std::max(largest, function(t_s));
  for (size_t k = 0; k <= num_instants; ++k) {
    values.push_back(function(step_s * static_cast<double>(k)));
    largest = std::max(largest, values.back());
  }
  // Nothing is between instants that all lie well below.
  const double near = kNear * largest;
  if (!std::isfinite(largest)) return largest;
  for (size_t k = 0; k < num_instants; ++k) {
    if (std::max(values[k], values[k + 1]) < near) continue;
    for (int j = 1; j <= kNumBetween; ++j) {
      const double share = static_cast<double>(j) / (kNumBetween + 1);
      largest = std::max(largest, function(step_s * (static_cast<double>(k) + share)));
    }
  }
  return largest;
}

}  // namespace calibrato
