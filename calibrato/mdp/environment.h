#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/motion/motion.h"

namespace calibrato {

/// What one step of an episode brought.
struct StepResult {
  Eigen::VectorXd observation;  ///< Y_{t+1}, of size observation_size().
  double reward = 0.0;          ///< R_t, the weighted sum of the terms below (paper, Eq. 3).
  /// Every term of the reward by name, weighted, in a fixed order: their sum is the reward.
  std::vector<std::pair<std::string, double>> terms;
  /// False if the carrier refused the action: nothing moved, the observation is the old one.
  bool executed = true;
};

/// Calibration as a Markov decision process (paper, section 3.2). The state is the history of
/// actions and observations, which the learner keeps; an environment only answers each action with
/// the next observation and reward. An action is one loop before scaling, 36 coefficients.
class Environment {
 public:
  virtual ~Environment() = default;

  [[nodiscard]] virtual int observation_size() const = 0;
  [[nodiscard]] virtual int horizon() const = 0;  ///< Loops an episode, T.

  /// Starts an episode with a fresh rig and fresh noise, both from this stream.
  /// @return Y_0, the observation before any data.
  virtual Eigen::VectorXd Reset(const Rng& rng) = 0;

  /// Executes one loop and calibrates over all loops so far.
  /// @pre Reset() was called, and fewer than horizon() steps since.
  virtual StepResult Step(const LoopCoefficients& action) = 0;

  /// Relative calibration error against the truth [-]; of the prior before any data.
  [[nodiscard]] virtual double relative_error() const = 0;
};

}  // namespace calibrato
