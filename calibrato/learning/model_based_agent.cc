#include "calibrato/learning/model_based_agent.h"

#include <algorithm>
#include <utility>

#include "calibrato/learning/byte_stream.h"

namespace calibrato {
namespace {

constexpr Eigen::Index kActionSize = LoopCoefficients::RowsAtCompileTime;

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

bool IsWhole(const NetworkWeights& network, size_t size) {
  return network.weights.size() == size && network.first_moment.size() == size &&
         network.second_moment.size() == size;
}

}  // namespace

ModelBasedAgent::ModelBasedAgent(const LearnOptions& options, int observation_size, int horizon,
                                 Rng rng)
    : learning_rate_(options.networks.learning_rate),
      planning_(options.planning),
      model_(observation_size, options.networks, options.planning.swarm.limit, rng) {
  for (int t = 0; t < horizon; ++t) particle_memory_.emplace_back(kActionSize * (horizon - t), 0);
}

void ModelBasedAgent::BeginTraining(const ReplayMemory& memory) {
  model_.SetNormalisation(NormalisationOf(memory));
}

TrainingLoss ModelBasedAgent::Train(const ReplayMemory& memory, Rng& rng) {
  return model_.Train(memory, rng);
}

Decision ModelBasedAgent::Decide(int step, const History& history, Exploration exploration,
                                 Rng& rng) const {
  const auto steps_left = static_cast<int>(particle_memory_.size()) - step;
  Plan plan = PlanAction(model_, history, steps_left, particle_memory_[static_cast<size_t>(step)],
                         planning_, exploration, rng);
  Decision decision;
  decision.action = plan.action;
  decision.predicted_return = plan.predicted_return;
  decision.expectation = {model_.PredictStep(model_.Encode(history), plan.action),
                          model_.normalisation().observation_stddev};
  decision.best = std::move(plan.best);
  decision.best_so_far = std::move(plan.best_so_far);
  return decision;
}

void ModelBasedAgent::Remember(int step, const std::vector<Decision>& decisions) {
  Eigen::MatrixXd& remembered = particle_memory_[static_cast<size_t>(step)];
  Eigen::Index most = 0;
  Eigen::Index total = 0;
  for (const Decision& decision : decisions) {
    most = std::max(most, decision.best.cols());
    total += decision.best.cols();
  }
  const auto num_kept = std::min<Eigen::Index>(planning_.swarm.num_remembered, total);
  Eigen::MatrixXd kept(remembered.rows(), num_kept);
  Eigen::Index next = 0;
  for (Eigen::Index rank = 0; rank < most; ++rank) {
    for (const Decision& decision : decisions) {
      if (next < num_kept && rank < decision.best.cols()) {
        kept.col(next++) = decision.best.col(rank);
      }
    }
  }
  remembered = std::move(kept);
}

void ModelBasedAgent::ScaleLearningRate(double factor) {
  model_.SetLearningRate(factor * learning_rate_);
}

std::string ModelBasedAgent::Bytes() const {
  const HistoryModel::State state = model_.state();
  ByteWriter writer;
  writer.Write(state.normalisation.observation_mean);
  writer.Write(state.normalisation.observation_stddev);
  writer.Write(state.normalisation.reward_mean);
  writer.Write(state.normalisation.reward_stddev);
  Write(state.dynamics, writer);
  Write(state.reward, writer);
  writer.Write(static_cast<int64_t>(particle_memory_.size()));
  for (const Eigen::MatrixXd& best : particle_memory_) writer.Write(best);
  return writer.bytes();
}

bool ModelBasedAgent::Restore(std::string_view bytes, const std::string& path) {
  ByteReader reader(bytes, path);
  HistoryModel::State state;
  state.normalisation.observation_mean = reader.ReadVector();
  state.normalisation.observation_stddev = reader.ReadVector();
  state.normalisation.reward_mean = reader.ReadDouble();
  state.normalisation.reward_stddev = reader.ReadDouble();
  state.dynamics = ReadNetwork(reader);
  state.reward = ReadNetwork(reader);
  const int64_t num_steps = reader.ReadInt();
  ParticleMemory particle_memory;
  for (int64_t t = 0; t < num_steps; ++t) particle_memory.push_back(reader.ReadMatrix());
  reader.ExpectEnd();
  bool fits = IsWhole(state.dynamics, model_.num_dynamics_weights()) &&
              IsWhole(state.reward, model_.num_reward_weights()) &&
              state.normalisation.observation_mean.size() == model_.observation_size() &&
              particle_memory.size() == particle_memory_.size();
  for (size_t t = 0; fits && t < particle_memory.size(); ++t) {
    fits = particle_memory[t].rows() == particle_memory_[t].rows();
  }
  if (!fits) return false;
  model_.Restore(state);
  particle_memory_ = std::move(particle_memory);
  return true;
}

std::optional<Agent::Model> ModelBasedAgent::model() const {
  return Model{model_.state(), particle_memory_};
}

}  // namespace calibrato
