#pragma once

#include <vector>

#include "calibrato/base/rng.h"

namespace calibrato {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// One figure of many trials: figures[m][i] is that of member m on rig i, NaN where there is none
/// (a failed calibration). The members of a method are its motions that were trained with different
/// seeds; most methods have one. All members were tried on the same rigs with the same noise.
using Figures = std::vector<std::vector<double>>;

[[nodiscard]] double Mean(const std::vector<double>& values);  ///< NaN for none.
[[nodiscard]] double Median(std::vector<double> values);       ///< NaN for none.

/// The figures that exist, member by member.
[[nodiscard]] std::vector<double> Existing(const Figures& figures);

/// 95 % interval of the mean by the percentile bootstrap with 2000 resamples (Efron and Tibshirani,
/// An Introduction to the Bootstrap, 1993, section 13.3). Members and rigs are drawn anew, each
/// with replacement: the interval is that of another training on other rigs with other noise. NaN
/// for none.
[[nodiscard]] Interval BootstrapMean(const Figures& figures, const Rng& rng);
[[nodiscard]] Interval BootstrapMean(const std::vector<double>& values, const Rng& rng);

/// Mean of the numerator over that of the denominator, over the rigs where both have a figure.
[[nodiscard]] double PairedRatio(const Figures& numerator, const Figures& denominator);

/// Its 95 % interval, rigs resampled in pairs: both belong to the same rig and noise, and what they
/// have in common cancels. Members of both are resampled apart.
/// @pre equal numbers of rigs
[[nodiscard]] Interval BootstrapRatio(const Figures& numerator, const Figures& denominator,
                                      const Rng& rng);
[[nodiscard]] Interval BootstrapRatio(const std::vector<double>& numerator,
                                      const std::vector<double>& denominator, const Rng& rng);

/// How often the ratio of the means would be as far from 1 by chance, were the two alike: a
/// two-sided permutation test that swaps the two on each rig or not, 4999 times (Ernst,
/// "Permutation methods", Statistical Science 2004). Each rig's figure is the mean over members. At
/// least 1 / 5000; NaN for fewer than two rigs where both have a figure.
[[nodiscard]] double PairedPermutationProbability(const Figures& numerator,
                                                  const Figures& denominator, Rng rng);

/// Probabilities adjusted for their number by Holm's step-down method (Scandinavian Journal of
/// Statistics 1979): below 0.05 all together are wrong with 5 % at most. NaN stays and does not
/// count.
[[nodiscard]] std::vector<double> HolmAdjusted(const std::vector<double>& probabilities);

/// Whether stated covariances are true: the mean of n normalised estimation errors squared (NEES),
/// each a chi-square variable of so many dimensions where they are (Bar-Shalom, Li, Kirubarajan,
/// Estimation with Applications to Tracking and Navigation, 2001, section 5.4).
struct ConsistencyTest {
  double mean_nees = 0.0;
  Interval expected;         ///< Of the mean, with 95 %.
  double probability = 0.0;  ///< Two-sided, of a mean so far off by chance.
};
/// All NaN for no values.
[[nodiscard]] ConsistencyTest TestConsistency(const std::vector<double>& nees, int dimension);

}  // namespace calibrato
