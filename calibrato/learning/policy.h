#pragma once

#include <cstdint>
#include <string>

#include "calibrato/learning/learn_options.h"
#include "calibrato/learning/networks.h"
#include "calibrato/learning/swarm.h"
#include "calibrato/motion/motion.h"

namespace calibrato {

/// What was learned: enough to play the motion, and to plan new ones by model predictive control.
/// On disk a folder:
///
///     policy.yaml  format version, where it comes from, options, normalisation
///     policy.bin   the networks' weights and the remembered particles
///     motion.yaml  the motion, see docs/formats.md section 3
struct Policy {
  // Where it comes from.
  Task task = Task::kIntrinsic;
  std::string preset;
  std::string stage;     ///< "learned", "fine-tuned"
  std::string mistakes;  ///< Of the original, repeated on purpose: NamesOf().
  uint64_t seed = 0;
  int num_episodes = 0;

  int horizon = 0;  ///< Loops an episode, T.
  int observation_size = 0;
  NetworkOptions networks;
  PlanningOptions planning;
  /// Of planners that plan on the two networks (ModelPlannerNames); else both are empty ...
  HistoryModel::State model;  ///< Without Adam's moments.
  ParticleMemory particle_memory;
  std::string agent;  ///< ... and this is Agent::Bytes().

  /// The loops that the model chose in the test with the highest return, executed open loop (paper,
  /// appendix A: "directly extract the action sequence chosen by the MPC controller").
  Motion motion;
};

/// @throws InputError if the folder can't be written.
void WritePolicy(const Policy& policy, const std::string& folder);

/// @throws InputError that names the file: missing, of another format version, damaged, or one file
/// not of the same policy as the others.
[[nodiscard]] Policy ReadPolicy(const std::string& folder);

/// The networks, ready to predict. @pre its planner is one of ModelPlannerNames().
[[nodiscard]] HistoryModel ModelOf(const Policy& policy);

}  // namespace calibrato
