#include "calibrato/learning/learn_options.h"

#include <algorithm>
#include <cmath>

#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"

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

}  // namespace

int NumWarmUpEpisodes(const LearnOptions& options) {
  return options.num_warm_up_episodes.value_or(std::clamp(options.num_episodes / 6, 1, 30));
}

void CheckOptions(const LearnOptions& options) {
  CheckRange("episodes", options.num_episodes, 2, kMany);
  CheckRange("warm-up episodes", NumWarmUpEpisodes(options), 1, options.num_episodes - 1);
  CheckRange("replay capacity", options.replay_capacity, 1, kMany);
  CheckRange("test every", options.test_every, 1, kMany);
  CheckRange("checkpoint every", options.checkpoint_every, 1, kMany);
  CheckRange("hidden size", options.networks.hidden_size, 1, 4096);
  CheckRange("minibatch size", options.networks.minibatch_size, 1, kMany);
  CheckRange("minibatches per call", options.networks.minibatches_per_call, 1, kMany);
  CheckNumber("learning rate", options.networks.learning_rate, false);
  CheckNumber("action jitter", options.networks.action_jitter, true);
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
