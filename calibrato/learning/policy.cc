#include "calibrato/learning/policy.h"

#include <algorithm>
#include <charconv>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/value.h"
#include "calibrato/learning/byte_stream.h"

namespace calibrato {
namespace {

constexpr int kFormatVersion = 2;
constexpr std::string_view kMagic = "CALPOLIC";
constexpr size_t kMaxBytes = size_t{1} << 30;
constexpr int64_t kMany = 1'000'000;

Value ToValue(const PlanningOptions& planning) {
  const SwarmOptions& swarm = planning.swarm;
  return Value::Object()
      .Set("planner", planning.planner)
      .Set("num_particles", swarm.num_particles)
      .Set("num_iterations", swarm.num_iterations)
      .Set("num_remembered", swarm.num_remembered)
      .Set("num_candidates", planning.num_candidates)
      .Set("social_weight", swarm.social_weight)
      .Set("gradient_weight", swarm.gradient_weight)
      .Set("inertia_weight", swarm.inertia_weight)
      .Set("action_limit", swarm.limit)
      .Set("frozen", swarm.frozen);
}

PlanningOptions PlanningFromValue(const Value& value) {
  PlanningOptions planning;
  planning.planner = value.At("planner").AsString();
  SwarmOptions& swarm = planning.swarm;
  swarm.frozen = value.At("frozen").AsBool();
  swarm.num_particles = static_cast<int>(value.At("num_particles").AsInt(1, 100'000));
  swarm.num_iterations = static_cast<int>(value.At("num_iterations").AsInt(0, kMany));
  swarm.num_remembered = static_cast<int>(value.At("num_remembered").AsInt(0, swarm.num_particles));
  planning.num_candidates =
      static_cast<int>(value.At("num_candidates").AsInt(1, swarm.num_particles));
  swarm.social_weight = value.At("social_weight").AsNonNegative();
  swarm.gradient_weight = value.At("gradient_weight").AsNonNegative();
  swarm.inertia_weight = value.At("inertia_weight").AsNonNegative();
  swarm.limit = value.At("action_limit").AsPositive();
  return planning;
}

Value ToValue(const Normalisation& normalisation) {
  return Value::Object()
      .Set("observation_mean", Value::Numbers(normalisation.observation_mean))
      .Set("observation_stddev", Value::Numbers(normalisation.observation_stddev))
      .Set("reward_mean", normalisation.reward_mean)
      .Set("reward_stddev", normalisation.reward_stddev);
}

Eigen::VectorXd VectorFromValue(const Value& value, int size) {
  const std::vector<double> numbers = value.AsDoubles(static_cast<size_t>(size));
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), size);
}

Normalisation NormalisationFromValue(const Value& value, int observation_size) {
  Normalisation normalisation;
  normalisation.observation_mean = VectorFromValue(value.At("observation_mean"), observation_size);
  normalisation.observation_stddev =
      VectorFromValue(value.At("observation_stddev"), observation_size);
  if (!(normalisation.observation_stddev.minCoeff() > 0.0)) {
    value.At("observation_stddev")
        .Fail("value out of range", "expected numbers > 0", "learn again");
  }
  normalisation.reward_mean = value.At("reward_mean").AsDouble();
  normalisation.reward_stddev = value.At("reward_stddev").AsPositive();
  return normalisation;
}

uint64_t SeedFromValue(const Value& value) {
  const std::string text = value.AsString();
  uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size()) {
    value.Fail("not a seed", "expected a whole number, found '" + text + "'", "learn again");
  }
  return seed;
}

bool PlansOnNetworks(const Policy& policy) {
  const std::vector<std::string> names = ModelPlannerNames();
  return std::find(names.begin(), names.end(), policy.planning.planner) != names.end();
}

std::string NumbersOf(const Policy& policy) {
  ByteWriter writer;
  if (!PlansOnNetworks(policy)) {
    writer.Write(std::string_view(policy.agent));
    return Sealed(kMagic, kFormatVersion, writer.bytes());
  }
  writer.Write(policy.model.dynamics.weights);
  writer.Write(policy.model.reward.weights);
  for (const Eigen::MatrixXd& best : policy.particle_memory) writer.Write(best);
  return Sealed(kMagic, kFormatVersion, writer.bytes());
}

void ReadNumbers(const std::string& path, Policy& policy) {
  const std::string bytes = ReadFile(path, kMaxBytes);
  ByteReader reader(Unsealed(kMagic, kFormatVersion, bytes, path), path);
  if (!PlansOnNetworks(policy)) {
    policy.agent = reader.ReadText();
    reader.ExpectEnd();
    return;
  }
  policy.model.dynamics.weights = reader.ReadFloats();
  policy.model.reward.weights = reader.ReadFloats();
  Rng unused(0);
  const HistoryModel model(policy.observation_size, policy.networks, policy.planning.swarm.limit,
                           unused);
  if (policy.model.dynamics.weights.size() != model.num_dynamics_weights() ||
      policy.model.reward.weights.size() != model.num_reward_weights()) {
    reader.Fail("its networks are not of the size that policy.yaml tells");
  }
  for (int t = 0; t < policy.horizon; ++t) {
    policy.particle_memory.push_back(reader.ReadMatrix());
    const Eigen::MatrixXd& best = policy.particle_memory.back();
    if (best.rows() != LoopCoefficients::RowsAtCompileTime * (policy.horizon - t)) {
      reader.Fail("its particles are not of the length that policy.yaml tells");
    }
  }
  reader.ExpectEnd();
}

}  // namespace

void WritePolicy(const Policy& policy, const std::string& folder) {
  Value header = Value::Object()
                     .Set("format_version", kFormatVersion)
                     .Set("task", TaskName(policy.task))
                     .Set("preset", policy.preset)
                     .Set("stage", policy.stage)
                     .Set("mistakes", policy.mistakes)
                     .Set("seed", std::to_string(policy.seed))
                     .Set("episodes", policy.num_episodes)
                     .Set("carrier", CarrierName(policy.motion.carrier))
                     .Set("horizon", policy.horizon)
                     .Set("observation_size", policy.observation_size)
                     .Set("hidden_size", policy.networks.hidden_size)
                     .Set("mask_histories", policy.networks.mask_histories)
                     .Set("planning", ToValue(policy.planning));
  if (PlansOnNetworks(policy)) header.Set("normalisation", ToValue(policy.model.normalisation));
  OutputFolder out(folder);
  out.Add("policy.yaml", ToYaml(header));
  out.Add("policy.bin", NumbersOf(policy));
  out.Add("motion.yaml", ToYaml(calibrato::ToValue(policy.motion)));
  out.Commit();
}

Policy ReadPolicy(const std::string& folder) {
  const Value header = ReadYaml(folder + "/policy.yaml");
  const Value& version = header.At("format_version");
  if (version.AsInt() != kFormatVersion) {
    version.Fail("cannot read policy",
                 "its format is version " + std::to_string(version.AsInt()) +
                     ", this program reads version " + std::to_string(kFormatVersion),
                 "use the program that wrote it, or learn again");
  }
  Policy policy;
  policy.task = TaskFromName(header.At("task").AsString());
  policy.preset = header.At("preset").AsString();
  policy.stage = header.At("stage").AsString();
  policy.mistakes = header.At("mistakes").AsString();
  policy.seed = SeedFromValue(header.At("seed"));
  policy.num_episodes = static_cast<int>(header.At("episodes").AsInt(0, kMany));
  policy.horizon = static_cast<int>(header.At("horizon").AsInt(1, 1000));
  policy.observation_size = static_cast<int>(header.At("observation_size").AsInt(1, 10'000));
  policy.networks.hidden_size = static_cast<int>(header.At("hidden_size").AsInt(1, 4096));
  policy.networks.mask_histories = header.At("mask_histories").AsBool();
  policy.planning = PlanningFromValue(header.At("planning"));
  if (PlansOnNetworks(policy)) {
    policy.model.normalisation =
        NormalisationFromValue(header.At("normalisation"), policy.observation_size);
  }
  ReadNumbers(folder + "/policy.bin", policy);
  policy.motion = MotionFromValue(ReadYaml(folder + "/motion.yaml"), nullptr);
  return policy;
}

HistoryModel ModelOf(const Policy& policy) {
  Rng unused(0);
  HistoryModel model(policy.observation_size, policy.networks, policy.planning.swarm.limit, unused);
  model.Restore(policy.model);
  return model;
}

}  // namespace calibrato
