#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calibrato/learning/replay_memory.h"

namespace calibrato {

/// All there is to a training run between two rounds of episodes. Random numbers need no place
/// here: every episode draws from streams of its own.
struct Checkpoint {
  std::vector<std::pair<std::string, std::string>> options;  ///< CourseOfTraining()
  std::vector<int> stage_episodes;  ///< Of every stage, as planned when it was written.
  int num_warm_up_episodes = 0;
  int num_episodes_done = 0;  ///< Random and training episodes.
  int64_t num_calibrations = 0;
  double best_return = 0.0;
  double best_test_return = 0.0;      ///< Of the stage's best test; without meaning if none.
  Eigen::MatrixXd best_test_actions;  ///< What it executed, a column a loop; none: no test so far.
  int num_rollbacks = 0;              ///< So far; each halved the learning rate.
  Eigen::VectorXd carried_over;       ///< Environment::carried_over(), of each environment.
  std::string agent;                  ///< Agent::Bytes()
  ReplayMemory replay_memory{1};
  std::string training_jsonl;  ///< All lines so far.
};

/// The content of checkpoint.bin.
[[nodiscard]] std::string ToBytes(const Checkpoint& checkpoint);

/// @throws InputError that names `path`, if it is another kind of file, of another version, cut
/// short or damaged.
[[nodiscard]] Checkpoint CheckpointFromBytes(std::string_view bytes, const std::string& path);

}  // namespace calibrato
