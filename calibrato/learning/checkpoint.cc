#include "calibrato/learning/checkpoint.h"

#include <algorithm>

#include "calibrato/learning/byte_stream.h"

namespace calibrato {
namespace {

constexpr std::string_view kMagic = "CALLEARN";
constexpr int64_t kVersion = 1;

void Write(const NetworkWeights& network, ByteWriter& writer) {
  writer.Write(network.weights);
  writer.Write(network.first_moment);
  writer.Write(network.second_moment);
  writer.Write(network.num_updates);
}

NetworkWeights ReadNetwork(ByteReader& reader) {
  NetworkWeights network;
  network.weights = reader.ReadFloats();
  network.first_moment = reader.ReadFloats();
  network.second_moment = reader.ReadFloats();
  network.num_updates = reader.ReadInt();
  return network;
}

void Write(const Normalisation& normalisation, ByteWriter& writer) {
  writer.Write(normalisation.observation_mean);
  writer.Write(normalisation.observation_stddev);
  writer.Write(normalisation.reward_mean);
  writer.Write(normalisation.reward_stddev);
}

Normalisation ReadNormalisation(ByteReader& reader) {
  Normalisation normalisation;
  normalisation.observation_mean = reader.ReadVector();
  normalisation.observation_stddev = reader.ReadVector();
  normalisation.reward_mean = reader.ReadDouble();
  normalisation.reward_stddev = reader.ReadDouble();
  return normalisation;
}

void Write(const Transition& transition, ByteWriter& writer) {
  writer.Write(static_cast<int64_t>(transition.history.actions.size()));
  for (const Eigen::VectorXd& observation : transition.history.observations) {
    writer.Write(observation);
  }
  for (const LoopCoefficients& action : transition.history.actions) {
    writer.Write(Eigen::VectorXd(action));
  }
  writer.Write(Eigen::VectorXd(transition.action));
  writer.Write(transition.reward);
  writer.Write(transition.next_observation);
}

LoopCoefficients ReadAction(ByteReader& reader) {
  const Eigen::VectorXd action = reader.ReadVector();
  if (action.size() != LoopCoefficients::RowsAtCompileTime) {
    reader.Fail("an action without 36 coefficients");
  }
  return action;
}

Transition ReadTransition(ByteReader& reader) {
  Transition transition;
  const int64_t num_actions = reader.ReadInt();
  if (num_actions < 0) reader.Fail("a history of negative length");
  for (int64_t k = 0; k <= num_actions; ++k) {
    transition.history.observations.push_back(reader.ReadVector());
  }
  for (int64_t k = 0; k < num_actions; ++k) {
    transition.history.actions.push_back(ReadAction(reader));
  }
  transition.action = ReadAction(reader);
  transition.reward = reader.ReadDouble();
  transition.next_observation = reader.ReadVector();
  return transition;
}

}  // namespace

std::string ToBytes(const Checkpoint& checkpoint) {
  ByteWriter writer;
  writer.Write(static_cast<int64_t>(checkpoint.options.size()));
  for (const auto& [name, value] : checkpoint.options) {
    writer.Write(std::string_view(name));
    writer.Write(std::string_view(value));
  }
  writer.Write(int64_t{checkpoint.num_warm_up_episodes});
  writer.Write(int64_t{checkpoint.num_episodes_done});
  writer.Write(checkpoint.num_calibrations);
  writer.Write(checkpoint.best_return);
  writer.Write(checkpoint.best_test_return);
  writer.Write(checkpoint.best_test_actions);
  Write(checkpoint.model.normalisation, writer);
  Write(checkpoint.model.dynamics, writer);
  Write(checkpoint.model.reward, writer);
  writer.Write(static_cast<int64_t>(checkpoint.replay_memory.capacity()));
  writer.Write(static_cast<int64_t>(checkpoint.replay_memory.size()));
  for (size_t i = 0; i < checkpoint.replay_memory.size(); ++i) {
    Write(checkpoint.replay_memory[i], writer);
  }
  writer.Write(static_cast<int64_t>(checkpoint.particle_memory.size()));
  for (const Eigen::MatrixXd& best : checkpoint.particle_memory) writer.Write(best);
  writer.Write(std::string_view(checkpoint.training_jsonl));
  return Sealed(kMagic, kVersion, writer.bytes());
}

Checkpoint CheckpointFromBytes(std::string_view bytes, const std::string& path) {
  ByteReader reader(Unsealed(kMagic, kVersion, bytes, path), path);
  Checkpoint checkpoint;
  const int64_t num_options = reader.ReadInt();
  for (int64_t i = 0; i < num_options; ++i) {
    std::string name = reader.ReadText();
    std::string value = reader.ReadText();
    checkpoint.options.emplace_back(std::move(name), std::move(value));
  }
  checkpoint.num_warm_up_episodes = static_cast<int>(reader.ReadInt());
  checkpoint.num_episodes_done = static_cast<int>(reader.ReadInt());
  checkpoint.num_calibrations = reader.ReadInt();
  checkpoint.best_return = reader.ReadDouble();
  checkpoint.best_test_return = reader.ReadDouble();
  checkpoint.best_test_actions = reader.ReadMatrix();
  checkpoint.model.normalisation = ReadNormalisation(reader);
  checkpoint.model.dynamics = ReadNetwork(reader);
  checkpoint.model.reward = ReadNetwork(reader);
  const int64_t capacity = reader.ReadInt();
  const int64_t num_transitions = reader.ReadInt();
  if (capacity < 1 || num_transitions > capacity) reader.Fail("a replay memory of impossible size");
  checkpoint.replay_memory = ReplayMemory(static_cast<size_t>(capacity));
  for (int64_t i = 0; i < num_transitions; ++i) {
    checkpoint.replay_memory.Add(ReadTransition(reader));
  }
  const int64_t num_steps = reader.ReadInt();
  for (int64_t t = 0; t < num_steps; ++t) {
    checkpoint.particle_memory.push_back(reader.ReadMatrix());
  }
  checkpoint.training_jsonl = reader.ReadText();
  reader.ExpectEnd();
  return checkpoint;
}

}  // namespace calibrato
