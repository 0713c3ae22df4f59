#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/motion/motion.h"

namespace calibrato {

/// One term of Eq. 3: weight times what the step added to a measure.
struct RewardTerm {
  std::string name;        ///< "path_length"
  std::string measure;     ///< With its unit, as keys of files have it: "path_length_m".
  double increment = 0.0;  ///< Of the measure, counted so that more is better or, with a negative
                           ///< weight, worse; in the measure's unit.
  double weight = 0.0;     ///< eta, per unit of the measure.
  [[nodiscard]] double value() const { return weight * increment; }
};

/// What one step of an episode brought.
struct StepResult {
  Eigen::VectorXd observation;    ///< Y_{t+1}, of size observation_size().
  double reward = 0.0;            ///< R_t, the sum of the terms' values (paper, Eq. 3).
  std::vector<RewardTerm> terms;  ///< In a fixed order.
  /// False if the carrier refused the action: nothing moved, the observation is the old one.
  bool executed = true;
};
[[nodiscard]] double SumOf(const std::vector<RewardTerm>& terms);

/// How much calibration an episode gets: what the paper's stages of training differ in.
struct EpisodeConditions {
  /// False: none. Observations that a calibration would give stay those of the prior, and so do
  /// the terms of the reward that it would earn.
  bool calibrate = true;
  /// Of the solver, each time it is called, >= 1; the environment's own choice unless given.
  std::optional<int> max_iterations;
};

/// Calibration as a Markov decision process (paper, section 3.2). The state is the history of
/// actions and observations, which the learner keeps; an environment only answers each action with
/// the next observation and reward. An action is one loop before scaling, 36 coefficients.
class Environment {
 public:
  virtual ~Environment() = default;

  /// Another one of the same task: episodes in parallel have an environment each.
  [[nodiscard]] virtual std::unique_ptr<Environment> Clone() const = 0;

  [[nodiscard]] virtual int observation_size() const = 0;
  [[nodiscard]] virtual int horizon() const = 0;  ///< Loops an episode, T.

  /// Of the episodes from the next Reset() on. Ignored where nothing is calibrated.
  virtual void SetConditions(const EpisodeConditions& conditions) { (void)conditions; }

  /// Starts an episode with a fresh rig and fresh noise, both from this stream.
  /// @return Y_0, the observation before any data.
  virtual Eigen::VectorXd Reset(const Rng& rng) = 0;

  /// Executes one loop and calibrates over all loops so far.
  /// @pre Reset() was called, and fewer than horizon() steps since.
  virtual StepResult Step(const LoopCoefficients& action) = 0;

  /// Relative calibration error against the truth [-]; of the prior before any data.
  [[nodiscard]] virtual double relative_error() const = 0;

  /// What an episode leaves to the next one in the same environment, for checkpoints. Nothing
  /// should: it is a mistake of the original (Mistake::kCarriedCoverage).
  [[nodiscard]] virtual double carried_over() const { return 0.0; }
  virtual void CarryOver(double carried_over) { (void)carried_over; }
};

}  // namespace calibrato
