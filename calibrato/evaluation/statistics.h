#pragma once

#include <vector>

#include "calibrato/base/rng.h"

namespace calibrato {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

[[nodiscard]] double Mean(const std::vector<double>& values);  ///< NaN for none.
[[nodiscard]] double Median(std::vector<double> values);       ///< NaN for none.

/// 95 % interval of the mean by the percentile bootstrap with 2000 resamples (Efron and Tibshirani,
/// An Introduction to the Bootstrap, 1993, section 13.3). NaN for none.
[[nodiscard]] Interval BootstrapMean(const std::vector<double>& values, Rng rng);

/// 95 % interval of mean(numerator) / mean(denominator), resampled in pairs: both belong to the
/// same rig and noise, and what they have in common cancels.
/// @pre equal sizes
[[nodiscard]] Interval BootstrapRatio(const std::vector<double>& numerator,
                                      const std::vector<double>& denominator, Rng rng);

}  // namespace calibrato
