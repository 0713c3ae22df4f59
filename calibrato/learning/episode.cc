#include "calibrato/learning/episode.h"

#include <algorithm>
#include <cmath>

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

void AddTerms(const std::vector<std::pair<std::string, double>>& terms, EpisodeRecord& record) {
  for (const auto& [name, value] : terms) {
    const auto known =
        std::find_if(record.terms.begin(), record.terms.end(),
                     [&name = name](const auto& term) { return term.first == name; });
    if (known == record.terms.end()) {
      record.terms.emplace_back(name, value);
    } else {
      known->second += value;
    }
  }
}

// The first of these that is not finite.
std::optional<std::string> FindDivergence(const std::optional<TrainingLoss>& loss,
                                          const LoopCoefficients& action) {
  if (loss && !std::isfinite(loss->dynamics)) return "dynamics loss not finite";
  if (loss && !std::isfinite(loss->reward)) return "reward loss not finite";
  if (!action.allFinite()) return "planned action not finite";
  return std::nullopt;
}

std::optional<std::string> FindDivergence(const StepResult& result) {
  if (!result.observation.allFinite()) return "observation not finite";
  if (!std::isfinite(result.reward)) return "reward not finite";
  return std::nullopt;
}

Value OrNull(const std::optional<double>& number) { return number ? Value(*number) : Value(); }

}  // namespace

EpisodeRecord PlayEpisode(Environment& environment, EpisodeKind kind, const Rng& environment_rng,
                          const std::function<Decision(int, const History&)>& decide,
                          const std::function<void(const Transition&)>& store) {
  EpisodeRecord record;
  record.kind = kind;
  History history;
  history.observations.push_back(environment.Reset(environment_rng));
  if (!history.observations.front().allFinite()) record.divergence = "observation not finite";
  for (int step = 0; step < environment.horizon() && !record.divergence; ++step) {
    const Decision decision = decide(step, history);
    if (step == 0) record.predicted_return = decision.predicted_return;
    if (decision.loss) {
      if (!record.loss) record.loss.emplace();
      record.loss->dynamics += decision.loss->dynamics / environment.horizon();
      record.loss->reward += decision.loss->reward / environment.horizon();
    }
    record.divergence = FindDivergence(decision.loss, decision.action);
    if (record.divergence) break;
    StepResult result = environment.Step(decision.action);
    record.divergence = FindDivergence(result);
    if (record.divergence) break;

    record.total_reward += result.reward;
    AddTerms(result.terms, record);
    if (result.executed) {
      record.executed.push_back(decision.action);
    } else {
      ++record.num_refused;
    }
    store({history, decision.action, result.reward, result.observation});
    history.actions.push_back(decision.action);
    history.observations.push_back(std::move(result.observation));
  }
  record.final_relative_error = environment.relative_error();
  return record;
}

Value ToValue(const EpisodeRecord& record, int episode) {
  Value terms = Value::Object();
  for (const auto& [name, value] : record.terms) terms.Set(name, value);
  double path_length_m = 0.0;
  for (const LoopCoefficients& action : record.executed) {
    path_length_m += PathLength(ScaledAction(action));
  }
  Value line = Value::Object();
  line.Set("episode", episode)
      .Set("kind", KindName(record.kind))
      .Set("return", record.total_reward)
      .Set("terms", std::move(terms))
      .Set("final_relative_error", record.final_relative_error)
      .Set("path_length_m", path_length_m)
      .Set("refused", record.num_refused)
      .Set("dynamics_loss", record.loss ? Value(record.loss->dynamics) : Value())
      .Set("reward_loss", record.loss ? Value(record.loss->reward) : Value())
      .Set("predicted_return", OrNull(record.predicted_return));
  return line;
}

}  // namespace calibrato
