#pragma once

#include <cstdint>
#include <vector>

namespace calibrato {

/// How much means over a time tau differ from one to the next.
struct AllanPoint {
  double tau_s = 0.0;
  /// Allan deviation, in the unit of the series: sigma(tau) with
  ///
  ///     sigma^2(tau) = <(mean over [t + tau, t + 2 tau) - mean over [t, t + tau))^2> / 2.
  double deviation = 0.0;
  int64_t num_samples = 0;  ///< In a mean: tau over the period.
};

/// The overlapping Allan deviation of an even series at taus that are spread evenly on a
/// logarithmic scale, from one period to a quarter of the series.
///
/// Every start t is used, from sums that are running: one pass over the series for each tau.
/// Source: W. J. Riley, "Handbook of Frequency Stability Analysis", NIST Special Publication 1065
/// (2008), section 5.2.4.
/// @param period_s  Between samples [s].
/// @param per_octave  How many taus for each doubling, as far as they differ. >= 1
[[nodiscard]] std::vector<AllanPoint> OverlappingAllanDeviation(const std::vector<double>& series,
                                                                double period_s, int per_octave);

/// One value of it. @pre 1 <= num_samples <= series.size() / 2
[[nodiscard]] AllanPoint OverlappingAllanDeviationAt(const std::vector<double>& series,
                                                     double period_s, int64_t num_samples);

/// The kinds of noise of an inertial sensor that slopes of the Allan deviation tell apart.
enum class NoiseSlope {
  kWhite,    ///< -1/2: white noise of the readings.
  kFlicker,  ///< 0: bias instability.
  kWalk      ///< +1/2: random walk of the bias.
};

/// Degrees of freedom of a value of the overlapping Allan variance: it is about chi-square
/// distributed with so many, so its relative standard deviation is sqrt(2 / degrees). Source: as
/// above, table 5 (D. A. Howe, D. W. Allan, J. A. Barnes, 1981).
/// @param series_size  Number of samples of the series. >= 4
[[nodiscard]] double AllanDegreesOfFreedom(NoiseSlope slope, int64_t series_size,
                                           int64_t num_samples);

}  // namespace calibrato
