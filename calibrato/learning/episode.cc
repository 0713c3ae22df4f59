#include "calibrato/learning/episode.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrato/motion/motion.h"

namespace calibrato {
namespace {

const char* KindName(EpisodeKind kind) {
  switch (kind) {
    case EpisodeKind::kRandom:
      return "random";
    case EpisodeKind::kTraining:
      return "training";
    case EpisodeKind::kTest:
      return "test";
  }
  return "";
}

void AddTerms(const std::vector<RewardTerm>& terms, EpisodeRecord& record) {
  for (const RewardTerm& term : terms) {
    auto known = std::find_if(record.terms.begin(), record.terms.end(),
                              [&](const TermSum& sum) { return sum.name == term.name; });
    if (known == record.terms.end()) {
      known = record.terms.insert(known, {term.name, term.measure, 0.0, 0.0});
    }
    known->value += term.value();
    known->increment += term.increment;
  }
}

// The first of these that is not finite.
std::optional<std::string> FindDivergence(const Decision& decision) {
  const std::optional<TrainingLoss>& loss = decision.loss;
  if (loss && !std::isfinite(loss->dynamics)) return "dynamics loss not finite";
  if (loss && !std::isfinite(loss->reward)) return "reward loss not finite";
  if (!decision.action.allFinite()) return "planned action not finite";
  return std::nullopt;
}

std::optional<std::string> FindDivergence(const StepResult& result) {
  if (!result.observation.allFinite()) return "observation not finite";
  if (!std::isfinite(result.reward)) return "reward not finite";
  return std::nullopt;
}

Value OrNull(const std::optional<double>& number) { return number ? Value(*number) : Value(); }

// The root of a mean of squares that was kept as it grew.
std::optional<double> Root(const std::optional<double>& sum_of_squares, int count) {
  if (!sum_of_squares) return std::nullopt;
  return std::sqrt(*sum_of_squares / count);
}

}  // namespace

Episode::Episode(Environment& environment, EpisodeKind kind, const Rng& environment_rng)
    : environment_(environment) {
  record_.kind = kind;
  history_.observations.push_back(environment_.Reset(environment_rng));
  if (!history_.observations.front().allFinite()) record_.divergence = "observation not finite";
}

void Episode::Note(const Decision& decision) {
  if (history_.actions.empty()) {
    record_.predicted_return = decision.predicted_return;
    record_.best_so_far = decision.best_so_far;
  }
  if (!decision.loss) return;
  if (!record_.loss) record_.loss.emplace();
  record_.loss->dynamics += decision.loss->dynamics;
  record_.loss->reward += decision.loss->reward;
  ++num_losses_;
}

void Episode::NoteError(const Decision& decision, const StepResult& result) {
  if (!decision.expectation) return;
  const auto& [prediction, unit] = *decision.expectation;
  const double reward_error = prediction.reward - result.reward;
  const double observation_error =
      (prediction.next_observation - result.observation).cwiseQuotient(unit).squaredNorm() /
      static_cast<double>(unit.size());
  record_.reward_prediction_error =
      record_.reward_prediction_error.value_or(0.0) + reward_error * reward_error;
  record_.observation_prediction_error =
      record_.observation_prediction_error.value_or(0.0) + observation_error;
  ++num_expectations_;
}

std::optional<Transition> Episode::Execute(const Decision& decision) {
  Note(decision);
  record_.divergence = FindDivergence(decision);
  if (record_.divergence) return std::nullopt;
  StepResult result = environment_.Step(decision.action);
  record_.divergence = FindDivergence(result);
  if (record_.divergence) return std::nullopt;

  NoteError(decision, result);
  record_.total_reward += result.reward;
  AddTerms(result.terms, record_);
  if (result.executed) {
    record_.executed.push_back(decision.action);
  } else {
    ++record_.num_refused;
  }
  Transition transition{history_, decision.action, result.reward, result.observation};
  history_.actions.push_back(decision.action);
  history_.observations.push_back(std::move(result.observation));
  return transition;
}

EpisodeRecord Episode::Record() const {
  EpisodeRecord record = record_;
  if (record.loss) {
    record.loss->dynamics /= num_losses_;
    record.loss->reward /= num_losses_;
  }
  record.reward_prediction_error = Root(record.reward_prediction_error, num_expectations_);
  record.observation_prediction_error =
      Root(record.observation_prediction_error, num_expectations_);
  record.final_relative_error = environment_.relative_error();
  return record;
}

Value ToValue(const EpisodeRecord& record, int episode, const std::string& stage) {
  Value terms = Value::Object();
  Value increments = Value::Object();
  for (const TermSum& term : record.terms) {
    terms.Set(term.name, term.value);
    increments.Set(term.measure, term.increment);
  }
  double path_length_m = 0.0;
  for (const LoopCoefficients& action : record.executed) {
    path_length_m += PathLength(ScaledAction(action));
  }
  Value line = Value::Object();
  line.Set("episode", episode)
      .Set("kind", KindName(record.kind))
      .Set("stage", stage)
      .Set("return", record.total_reward)
      .Set("terms", std::move(terms))
      .Set("increments", std::move(increments))
      .Set("final_relative_error", record.final_relative_error)
      .Set("path_length_m", path_length_m)
      .Set("refused", record.num_refused)
      .Set("dynamics_loss", record.loss ? Value(record.loss->dynamics) : Value())
      .Set("reward_loss", record.loss ? Value(record.loss->reward) : Value())
      .Set("predicted_return", OrNull(record.predicted_return))
      .Set("reward_prediction_error", OrNull(record.reward_prediction_error))
      .Set("observation_prediction_error", OrNull(record.observation_prediction_error))
      .Set("best_so_far",
           record.best_so_far.empty() ? Value() : Value::Numbers(record.best_so_far));
  return line;
}

}  // namespace calibrato
