#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "calibrato/learning/design_rounds.h"
#include "calibrato/learning/trainer.h"
#include "calibrato/mdp/motion_design.h"

namespace calibrato {

/// One rig that a motion is judged on. It plays episode `index` of every round, with the same rig
/// and noise each time, so that rounds compare.
using Judge = std::function<MotionJudgement(const TimedMotion& motion, uint64_t index)>;

/// How to learn with the preset `best`.
struct DesignLearnOptions {
  /// Its limits are those of the carrier; its rigs what is believed of the rig before any data, the
  /// nominal one first, which alone is designed for where many starts are tried.
  MotionDesignProblem problem;
  Carrier carrier = Carrier::kFree;
  MultistartOptions starts;       ///< For the nominal rig.
  int robust_evaluations = 150;   ///< For all rigs, from the best of them.
  int evaluations_of_round = 60;  ///< For all rigs, of each later round's motion.
  int num_episodes = 96;          ///< >= episodes_per_round; whole rounds are played.
  int episodes_per_round = 8;     ///< >= 1
  uint64_t seed = 1;
  /// What the judge was made of, in words: a checkpoint of another one is refused.
  std::string environment;
  bool resume = false;
};

/// Learning where a model exists (preset `best`). Motions are designed by their expected
/// information, robustly over the rigs that may come; what is learned is where that expectation
/// fails. The first round trusts it up to the carrier's limits. Each later one draws those limits
/// in (trusted_limits.h) to where the loss may be least: the mean less one sigma of the expected
/// loss, of what the stated one adds to it, and of the errors' size over what is stated, each a
/// Gaussian process of what the rounds so far have shown; it designs anew within them, and plays.
/// The motion of the round whose believed loss is least is the policy's: the loss that was stated,
/// which all rounds have of the same rigs and noise, as it is, and the errors' size, which a few
/// rigs tell but roughly, smoothed.
///
/// Where the expectation is right, the first round wins, and learning adds nothing: then it says
/// so.
///
/// Writes into `folder`: training.jsonl, checkpoint.json (both after each round)
/// and, when done, policy/motion.yaml and policy/policy.yaml. The same options give the same bytes,
/// for any number of threads, whether or not the run was interrupted, killed and resumed.
///
/// @param interrupt  May be null. Once true, the run stops after the running round.
/// @param team  As Learn: episodes and first starts are divided.
/// @throws InputError as Learn; or if nothing is learned from any start.
[[nodiscard]] LearnResult LearnByDesign(const DesignLearnOptions& options, const Judge& judge,
                                        const std::string& folder,
                                        const std::atomic<bool>* interrupt = nullptr,
                                        Team* team = nullptr);

}  // namespace calibrato
