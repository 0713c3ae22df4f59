#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/learning/agent.h"
#include "calibrato/learning/history.h"
#include "calibrato/mdp/environment.h"

namespace calibrato {

/// What chose the actions of an episode.
enum class EpisodeKind {
  kRandom,    ///< Uniform within the limit.
  kTraining,  ///< Planned, with exploration.
  kTest,      ///< Planned, without.
};

/// A term of the reward, summed over an episode.
struct TermSum {
  std::string name;
  std::string measure;     ///< With its unit: RewardTerm::measure.
  double value = 0.0;      ///< Weighted: a part of the return.
  double increment = 0.0;  ///< Of the measure.
};

/// What came of an episode.
struct EpisodeRecord {
  EpisodeKind kind = EpisodeKind::kRandom;
  std::vector<LoopCoefficients> executed;  ///< Without refused actions; before scaling.
  int num_refused = 0;
  double total_reward = 0.0;
  std::vector<TermSum> terms;
  double final_relative_error = 0.0;       ///< [-]
  std::optional<TrainingLoss> loss;        ///< Mean over the steps.
  std::optional<double> predicted_return;  ///< At the first step.
  /// Root mean square over the steps of predicted - realised, of rewards as they are and of
  /// observations in the agent's units (each number counts alike).
  std::optional<double> reward_prediction_error;
  std::optional<double> observation_prediction_error;
  std::vector<double> best_so_far;  ///< Of the first step's search.
  /// Why the episode was broken off: a number that is not finite.
  std::optional<std::string> divergence;
};

/// One episode, step by step.
class Episode {
 public:
  /// Resets the environment, which must outlive this and be nobody else's until the end.
  Episode(Environment& environment, EpisodeKind kind, const Rng& environment_rng);

  [[nodiscard]] const History& history() const { return history_; }
  [[nodiscard]] bool diverged() const { return record_.divergence.has_value(); }

  /// Executes one step. @return What came of it; nothing if a number is not finite.
  /// @pre not diverged, fewer steps than the horizon so far.
  std::optional<Transition> Execute(const Decision& decision);

  /// What came of it all, up to here.
  [[nodiscard]] EpisodeRecord Record() const;

 private:
  void Note(const Decision& decision);
  void NoteError(const Decision& decision, const StepResult& result);

  Environment& environment_;
  History history_;
  EpisodeRecord record_;
  int num_losses_ = 0;
  int num_expectations_ = 0;
};

/// One line of training.jsonl. The path length is that of the executed actions; what does not
/// exist (the loss of a random episode) is null.
[[nodiscard]] Value ToValue(const EpisodeRecord& record, int episode, const std::string& stage);

}  // namespace calibrato
