#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/learning/mpc.h"
#include "calibrato/learning/networks.h"
#include "calibrato/mdp/environment.h"
#include "calibrato/mdp/original_mistakes.h"
#include "calibrato/motion/motion.h"

namespace calibrato {

/// A part of training in which all episodes are alike. When the next one begins the replay memory
/// is emptied, since the same steps are now rewarded differently, and tests start to be compared
/// anew; networks, normalisation and remembered particles stay.
struct TrainingStage {
  std::string name = "learned";  ///< Of the policy at its end, which has a motion of its own.
  int num_episodes = 0;          ///< >= 1; of the last stage not used: it has all that are left.
  EpisodeConditions training;
  EpisodeConditions test;
};

/// The paper's stages of a task (section 4 and appendix A). Intrinsic and joint: one, `learned`.
/// Extrinsic: `learned` without calibrations, and then `fine-tuned` with them, the solver limited
/// to one iteration in training and ten in tests; 1000 and 650 episodes, or as many parts of
/// `num_episodes` >= 2.
[[nodiscard]] std::vector<TrainingStage> PaperStages(Task task, int num_episodes);
/// 1000, 1650 and 1000.
[[nodiscard]] int PaperNumEpisodes(Task task);

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

  int num_episodes = 60;  ///< Of all stages, with the random ones, without tests; > warm-up.
  /// At least one. When resuming, the stages before the last are as long as the checkpoint's.
  std::vector<TrainingStage> stages = {TrainingStage()};
  /// Random episodes before any training, >= 1. Unless given: a sixth of all, at least 1, at most
  /// 30 as in the original implementation; when resuming, what the checkpoint has.
  std::optional<int> num_warm_up_episodes;
  /// Episodes that are played side by side, >= 1. They learn and plan step by step together: before
  /// each step the networks train once for every episode, then all plan with what was learned, and
  /// then all store what came of it. One is the paper's Algorithm 1.
  int round = 1;
  int replay_capacity = 1000;  ///< Transitions, >= 1.
  NetworkOptions networks;
  PlanningOptions planning;
  Mistakes mistakes;  ///< Of these: tests remembered, last test.

  int test_every = 2;        ///< Episodes between tests without exploration, >= 1.
  int checkpoint_every = 1;  ///< Episodes between checkpoints, >= 1: rounded up to whole rounds.
  /// How often a run that diverged goes back to its last checkpoint, with half the learning rate,
  /// >= 0.
  int max_rollbacks = 3;
  bool resume = false;  ///< Continue from the folder's checkpoint.
};

[[nodiscard]] int NumWarmUpEpisodes(const LearnOptions& options);

/// Index of the stage that episode number `episode` (from 0) belongs to.
[[nodiscard]] size_t StageOf(const LearnOptions& options, int episode);
/// First episode of a stage; num_episodes for the one after the last.
[[nodiscard]] int FirstEpisode(const LearnOptions& options, size_t stage);

/// @throws InputError that names the first option out of its range.
void CheckOptions(const LearnOptions& options);

/// Every option that the course of training depends on, by name, as text: two runs whose lists are
/// equal produce the same bytes, episode by episode. Not among them: how many episodes there are,
/// so that a finished run can be continued, and where checkpoints fall.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> CourseOfTraining(
    const LearnOptions& options);

}  // namespace calibrato
