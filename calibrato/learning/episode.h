#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/learning/history.h"
#include "calibrato/learning/networks.h"
#include "calibrato/mdp/environment.h"

namespace calibrato {

/// What chose the actions of an episode.
enum class EpisodeKind {
  kRandom,    ///< Uniform within the limit.
  kTraining,  ///< Planned, with exploration.
  kTest,      ///< Planned, without.
};

/// A decision for one step, and what there is to report of it.
struct Decision {
  LoopCoefficients action;
  std::optional<TrainingLoss> loss;        ///< Of the training before this step.
  std::optional<double> predicted_return;  ///< From this step to the end.
};

/// What came of an episode.
struct EpisodeRecord {
  EpisodeKind kind = EpisodeKind::kRandom;
  std::vector<LoopCoefficients> executed;  ///< Without refused actions; before scaling.
  int num_refused = 0;
  double total_reward = 0.0;
  std::vector<std::pair<std::string, double>> terms;  ///< Summed by name.
  double final_relative_error = 0.0;                  ///< [-]
  std::optional<TrainingLoss> loss;                   ///< Mean over the steps.
  std::optional<double> predicted_return;             ///< At the first step.
  /// Why the episode was broken off: a number that is not finite.
  std::optional<std::string> divergence;
};

/// Plays one episode: decides each step from the history so far, executes it, and hands over what
/// came of it before the next decision.
/// @param decide  Of (step, history).
[[nodiscard]] EpisodeRecord PlayEpisode(Environment& environment, EpisodeKind kind,
                                        const Rng& environment_rng,
                                        const std::function<Decision(int, const History&)>& decide,
                                        const std::function<void(const Transition&)>& store);

/// One line of training.jsonl. The path length is that of the executed actions; what does not
/// exist (the loss of a random episode) is null.
[[nodiscard]] Value ToValue(const EpisodeRecord& record, int episode);

}  // namespace calibrato
