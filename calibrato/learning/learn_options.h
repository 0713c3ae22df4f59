#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/learning/mpc.h"
#include "calibrato/learning/networks.h"
#include "calibrato/motion/motion.h"

namespace calibrato {

/// How to learn. The defaults are the preset `paper`: model-based heuristic reinforcement learning
/// (paper, Algorithm 1 and Table 5), without the mistakes of its original implementation.
struct LearnOptions {
  Task task = Task::kIntrinsic;      ///< For the files; the environment decides what is learned.
  Carrier carrier = Carrier::kFree;  ///< Of the learned motion.
  BasePose base_pose;                ///< Of the learned motion.
  double loop_duration_s = 5.0;      ///< Of the learned motion's loops, > 0 [s].
  std::string preset = "paper";      ///< For the files.
  uint64_t seed = 1;                 ///< Of all that is random.
  /// What the environment was made of, in words: a checkpoint of another one is refused.
  std::string environment;

  int num_episodes = 60;  ///< With the random ones, without tests; > warm-up.
  /// Random episodes before any training, >= 1. Unless given: a sixth of all, at least 1, at most
  /// 30 as in the original implementation; when resuming, what the checkpoint has.
  std::optional<int> num_warm_up_episodes;
  int replay_capacity = 1000;  ///< Transitions, >= 1.
  NetworkOptions networks;
  PlanningOptions planning;

  int test_every = 2;        ///< Episodes between tests without exploration, >= 1.
  int checkpoint_every = 5;  ///< Episodes between checkpoints, >= 1.
  bool resume = false;       ///< Continue from the folder's checkpoint.
};

[[nodiscard]] int NumWarmUpEpisodes(const LearnOptions& options);

/// @throws InputError that names the first option out of its range.
void CheckOptions(const LearnOptions& options);

/// Every option that the course of training depends on, by name, as text: two runs whose lists are
/// equal produce the same bytes, episode by episode. Not among them: how many episodes there are,
/// so that a finished run can be continued, and where checkpoints fall.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> CourseOfTraining(
    const LearnOptions& options);

}  // namespace calibrato
