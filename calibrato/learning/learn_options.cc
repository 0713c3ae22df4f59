#include "calibrato/learning/learn_options.h"

#include <algorithm>
#include <cmath>

#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/learning/agent.h"

namespace calibrato {
namespace {

void CheckRange(const std::string& name, int value, int low, int high) {
  if (value >= low && value <= high) return;
  throw InputError({"option out of range", name,
                    "expected " + std::to_string(low) + " to " + std::to_string(high) + ", found " +
                        std::to_string(value),
                    "change it"});
}

void CheckNumber(const std::string& name, double value, bool may_be_zero) {
  if (std::isfinite(value) && (value > 0.0 || (may_be_zero && value == 0.0))) return;
  throw InputError({"option out of range", name,
                    std::string("expected a number ") + (may_be_zero ? ">= 0" : "> 0") +
                        ", found " + std::to_string(value),
                    "change it"});
}

constexpr int kMany = 1'000'000;

// How far calibration goes, in words.
std::string Describe(const EpisodeConditions& conditions) {
  if (!conditions.calibrate) return "no calibration";
  return conditions.max_iterations ? std::to_string(*conditions.max_iterations) + " iterations"
                                   : "whole calibrations";
}

std::string Describe(const LearnOptions& options) {
  std::string text;
  for (size_t i = 0; i < options.stages.size(); ++i) {
    const TrainingStage& stage = options.stages[i];
    const bool is_last = i + 1 == options.stages.size();
    text += (i == 0 ? "" : "; ") + stage.name + ": " + Describe(stage.training) +
            " (tests: " + Describe(stage.test) + ")";
    if (!is_last) text += " in " + std::to_string(stage.num_episodes) + " episodes";
  }
  return text;
}

}  // namespace

int PaperNumEpisodes(Task task) { return task == Task::kExtrinsic ? 1650 : 1000; }

std::vector<TrainingStage> PaperStages(Task task, int num_episodes) {
  if (task != Task::kExtrinsic) return {TrainingStage()};
  TrainingStage learned;
  learned.num_episodes = std::clamp(static_cast<int>(std::lround(num_episodes * 1000.0 / 1650.0)),
                                    1, std::max(1, num_episodes - 1));
  learned.training.calibrate = false;
  learned.test.calibrate = false;
  TrainingStage fine_tuned;
  fine_tuned.name = "fine-tuned";
  fine_tuned.training.max_iterations = 1;
  fine_tuned.test.max_iterations = 10;
  return {learned, fine_tuned};
}

size_t StageOf(const LearnOptions& options, int episode) {
  size_t stage = 0;
  while (stage + 1 < options.stages.size() && episode >= FirstEpisode(options, stage + 1)) ++stage;
  return stage;
}

int FirstEpisode(const LearnOptions& options, size_t stage) {
  if (stage >= options.stages.size()) return options.num_episodes;
  int first = 0;
  for (size_t i = 0; i < stage; ++i) first += options.stages[i].num_episodes;
  return first;
}

int NumWarmUpEpisodes(const LearnOptions& options) {
  const int sixth = std::clamp(options.num_episodes / 6, 1, 30);
  if (options.num_warm_up_episodes || options.stages.size() == 1) {
    return options.num_warm_up_episodes.value_or(sixth);
  }
  // All of them in the first stage, which must have something left to train.
  return std::clamp(sixth, 1, std::max(1, options.stages.front().num_episodes - 1));
}

void CheckOptions(const LearnOptions& options) {
  // A first stage has a warm-up and something to train; each other one has something to train.
  const int num_at_least = 1 + std::max(1, static_cast<int>(options.stages.size()));
  CheckRange("episodes", options.num_episodes, num_at_least, kMany);
  CheckRange("warm-up episodes", NumWarmUpEpisodes(options), 1, options.num_episodes - 1);
  if (options.stages.empty()) {
    throw InputError({"option out of range", "stages", "there is none", "give at least one"});
  }
  for (size_t i = 0; i + 1 < options.stages.size(); ++i) {
    CheckRange("episodes of stage " + options.stages[i].name, options.stages[i].num_episodes, 1,
               options.num_episodes - 1);
  }
  // The networks' units are those of the warm-up, which the memory must still hold.
  if (options.stages.size() > 1) {
    CheckRange("warm-up episodes", NumWarmUpEpisodes(options), 1,
               options.stages.front().num_episodes - 1);
  }
  const int num_before_last = FirstEpisode(options, options.stages.size() - 1);
  CheckRange("episodes", options.num_episodes, num_before_last + 1, kMany);
  CheckRange("round", options.round, 1, 1000);
  CheckRange("rollbacks", options.max_rollbacks, 0, 100);
  CheckRange("replay capacity", options.replay_capacity, 1, kMany);
  CheckRange("test every", options.test_every, 1, kMany);
  CheckRange("checkpoint every", options.checkpoint_every, 1, kMany);
  CheckRange("hidden size", options.networks.hidden_size, 1, 4096);
  CheckRange("minibatch size", options.networks.minibatch_size, 1, kMany);
  CheckRange("minibatches per call", options.networks.minibatches_per_call, 1, kMany);
  CheckNumber("learning rate", options.networks.learning_rate, false);
  CheckNumber("action jitter", options.networks.action_jitter, true);
  const std::vector<std::string> planners = AgentNames();
  if (std::find(planners.begin(), planners.end(), options.planning.planner) == planners.end()) {
    std::string list;
    for (const std::string& name : planners) list += (list.empty() ? "" : ", ") + name;
    throw InputError({"unknown planner '" + options.planning.planner + "'", "", "there are " + list,
                      "choose one of them"});
  }
  const SwarmOptions& swarm = options.planning.swarm;
  CheckRange("particles", swarm.num_particles, 1, 100'000);
  CheckRange("swarm iterations", swarm.num_iterations, 0, kMany);
  CheckRange("remembered particles", swarm.num_remembered, 0, swarm.num_particles);
  CheckRange("candidates", options.planning.num_candidates, 1, swarm.num_particles);
  CheckNumber("social weight", swarm.social_weight, true);
  CheckNumber("gradient weight", swarm.gradient_weight, true);
  CheckNumber("inertia weight", swarm.inertia_weight, true);
  CheckNumber("action limit", swarm.limit, false);
  CheckNumber("loop duration", options.loop_duration_s, false);
}

std::vector<std::pair<std::string, std::string>> CourseOfTraining(const LearnOptions& options) {
  const SwarmOptions& swarm = options.planning.swarm;
  return {{"seed", std::to_string(options.seed)},
          {"task", TaskName(options.task)},
          {"carrier", CarrierName(options.carrier)},
          {"preset", options.preset},
          {"environment", options.environment},
          {"stages", Describe(options)},
          {"round", std::to_string(options.round)},
          {"mistakes", NamesOf(options.mistakes)},
          {"planner", options.planning.planner},
          {"masked histories", options.networks.mask_histories ? "yes" : "no"},
          {"frozen swarm", swarm.frozen ? "yes" : "no"},
          {"warm-up episodes", std::to_string(NumWarmUpEpisodes(options))},
          {"replay capacity", std::to_string(options.replay_capacity)},
          {"test every", std::to_string(options.test_every)},
          {"hidden size", std::to_string(options.networks.hidden_size)},
          {"learning rate", FormatNumber(options.networks.learning_rate)},
          {"minibatch size", std::to_string(options.networks.minibatch_size)},
          {"minibatches per call", std::to_string(options.networks.minibatches_per_call)},
          {"action jitter", FormatNumber(options.networks.action_jitter)},
          {"particles", std::to_string(swarm.num_particles)},
          {"swarm iterations", std::to_string(swarm.num_iterations)},
          {"remembered particles", std::to_string(swarm.num_remembered)},
          {"candidates", std::to_string(options.planning.num_candidates)},
          {"social weight", FormatNumber(swarm.social_weight)},
          {"gradient weight", FormatNumber(swarm.gradient_weight)},
          {"inertia weight", FormatNumber(swarm.inertia_weight)},
          {"action limit", FormatNumber(swarm.limit)}};
}

}  // namespace calibrato
