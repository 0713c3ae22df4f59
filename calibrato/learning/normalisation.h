#pragma once

#include <Eigen/Core>

#include "calibrato/learning/replay_memory.h"

namespace calibrato {

/// Units in which the networks see observations and rewards: mean 0, standard deviation 1 over a
/// set of transitions.
///
/// Computed once, from the random episodes, and then kept: a network's weights mean something only
/// in the units they were trained in, and statistics that moved with the replay memory would shift
/// every prediction without a training step.
struct Normalisation {
  Eigen::VectorXd observation_mean;
  Eigen::VectorXd observation_stddev;  ///< > 0; 1 where the set shows no variation.
  double reward_mean = 0.0;
  double reward_stddev = 1.0;  ///< > 0

  /// Beyond so many standard deviations inputs and targets are cut off, so that one failed
  /// calibration can't throw a network off its course.
  static constexpr double kCutOff = 10.0;

  [[nodiscard]] Eigen::VectorXd Normalised(const Eigen::VectorXd& observation) const;
  [[nodiscard]] double Normalised(double reward) const;
};

/// Mean 0 and standard deviation 1, in the units of the environment itself.
[[nodiscard]] Normalisation UnitNormalisation(int observation_size);

/// Over both observations of every transition, before and after, and over all rewards.
/// @pre memory.size() > 0
[[nodiscard]] Normalisation NormalisationOf(const ReplayMemory& memory);

}  // namespace calibrato
