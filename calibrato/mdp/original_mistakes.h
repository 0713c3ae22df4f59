#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace calibrato {

/// Mistakes of the paper's original implementation (docs/differences.md), each a switch, so that
/// what it cost can be measured. All are off unless asked for.
enum class Mistake {
  /// The calibration ran after the last loop only, and the estimate before it was zero: the error
  /// fell from 1 to nearly 0 whatever was done, a constant reward. Observations of what a
  /// calibration gives stayed those of the prior until then.
  kConstantAccuracy,
  /// Coverage carried over: an episode's first loop was rewarded for its coverage minus that at the
  /// end of the episode before (tests included).
  kCarriedCoverage,
  /// Coverage fell to zero, in reward and observation, if the last image of a loop had no board.
  kLostCoverage,
  /// "Entropy of IMU data" was 0.1 of that of four quaternion components, each value a bin of its
  /// own: 0.4 ln N / ln 2.73 of N <= 2000 samples, a reward for duration.
  kDurationEntropy,
  /// Information was the trace of the inverse of the normal equations' own 6 x 6 part: all else
  /// known, metres and radians summed, weighted by 1e7.
  kConditionalCovariance,
  /// The estimator was told gyroscope noise and random walk in each other's place, and figures of a
  /// sample as densities.
  kSwappedNoise,
  /// The true translation was computed as if the IMU's 0.03 m slide acted along the unturned axis:
  /// errors were measured against a truth that is off by up to 3 mm.
  kWrongTruth,
  /// A refused motion came back as zeros with reward 0, as if it were an outcome.
  kSilentRefusals,
  /// The swarm had no inertia and no social part, and steps of 0.1 U(0, 1) 1e-4 times the gradient:
  /// it did not move.
  kFrozenSwarm,
  /// The recurrent layers skipped pairs without an action before (the first) or without a
  /// calibration's observation.
  kMaskedHistories,
  /// Tests overwrote the particles that training remembered.
  kTestsRemembered,
  /// The motion was that of the last test, not of the best.
  kLastTest,
};

using Mistakes = std::set<Mistake>;

[[nodiscard]] std::string MistakeName(Mistake mistake);  ///< "constant-accuracy", ..
[[nodiscard]] std::vector<std::string> MistakeNames();   ///< Of all, in the order of the enum.

/// "constant-accuracy,frozen-swarm", or "all", or "" for none. @throws InputError with the list.
[[nodiscard]] Mistakes MistakesFromNames(std::string_view names);
/// The same the other way round, in the order of the enum; "none" for none.
[[nodiscard]] std::string NamesOf(const Mistakes& mistakes);

}  // namespace calibrato
