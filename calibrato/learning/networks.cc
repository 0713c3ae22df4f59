#include "calibrato/learning/networks.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <mutex>
#include <utility>

#include "calibrato/base/parallel.h"
#include "calibrato/learning/recurrent_network.h"

namespace calibrato {
namespace {

using torch::Tensor;
using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int kActionSize = LoopCoefficients::RowsAtCompileTime;

// More threads don't make networks of this size faster, and would change the order of sums.
void UseOneThread() {
  static std::once_flag once;
  std::call_once(once, [] { at::set_num_interop_threads(1); });
  at::set_num_threads(1);
}

Tensor Copy(const RowMajor& rows) {
  Tensor tensor = torch::empty({rows.rows(), rows.cols()});
  std::copy(rows.data(), rows.data() + rows.size(), tensor.data_ptr<float>());
  return tensor;
}

Tensor CopyAsRow(const Eigen::VectorXf& vector) { return Copy(RowMajor(vector.transpose())); }

Eigen::VectorXf RowOf(const Tensor& tensor) {
  return Eigen::Map<const Eigen::VectorXf>(tensor.data_ptr<float>(), tensor.numel());
}

// Transitions to learn from, those with the longest history first.
struct Minibatch {
  SequenceBatch histories;
  Tensor actions;
  Tensor observations;  // Targets of the dynamics ...
  Tensor rewards;       // ... and of the reward.
};

}  // namespace

struct HistoryModel::Impl {
  Impl(int observation_size, const NetworkOptions& network_options, double limit, Rng& rng)
      : num_observations(observation_size),
        options(network_options),
        action_limit(limit),
        normalisation(UnitNormalisation(observation_size)),
        dynamics(observation_size + kActionSize, kActionSize, options.hidden_size, observation_size,
                 rng),
        reward(observation_size + kActionSize, kActionSize, options.hidden_size, 1, rng) {}

  // (Y_k, A_{k-1}) of a history, k = 0 .. t.
  void WritePair(const History& history, size_t k, RowMajor::RowXpr row) const {
    row.head(num_observations) =
        normalisation.Normalised(history.observations[k]).cast<float>().transpose();
    row.tail(kActionSize).setZero();
    if (k > 0) row.tail(kActionSize) = NormalisedAction(history.actions[k - 1]).transpose();
  }

  Eigen::VectorXf NormalisedAction(const LoopCoefficients& action) const {
    return (action / action_limit).cast<float>();
  }

  // Which pairs of a history are encoded.
  std::vector<size_t> EncodedPairs(const History& history) const {
    std::vector<size_t> pairs;
    for (size_t k = 0; k < history.observations.size(); ++k) {
      const bool masked = k == 0 || history.observations[k] == history.observations[0];
      if (!(options.mask_histories && masked)) pairs.push_back(k);
    }
    return pairs;
  }

  // @param histories  Those with the most encoded pairs first.
  SequenceBatch MakeBatch(const std::vector<const History*>& histories) const {
    SequenceBatch batch;
    batch.num_sequences = static_cast<int64_t>(histories.size());
    std::vector<std::vector<size_t>> encoded;
    size_t num_pairs = 0;
    for (const History* history : histories) {
      encoded.push_back(EncodedPairs(*history));
      num_pairs += encoded.back().size();
    }
    const size_t longest = encoded.front().size();
    RowMajor pairs(static_cast<Eigen::Index>(num_pairs), num_observations + kActionSize);
    Eigen::Index row = 0;
    for (size_t s = 0; s < longest; ++s) {
      int64_t num_active = 0;
      for (size_t i = 0; i < histories.size(); ++i) {
        const size_t start = longest - encoded[i].size();
        if (start > s) break;
        WritePair(*histories[i], encoded[i][s - start], pairs.row(row++));
        ++num_active;
      }
      batch.num_active.push_back(num_active);
    }
    batch.pairs = Copy(pairs);
    return batch;
  }

  Minibatch DrawMinibatch(const ReplayMemory& memory, Rng& rng) const {
    std::vector<const Transition*> drawn(static_cast<size_t>(options.minibatch_size));
    for (const Transition*& transition : drawn) {
      transition = &memory[rng.UniformIndex(memory.size())];
    }
    std::stable_sort(drawn.begin(), drawn.end(), [this](const Transition* a, const Transition* b) {
      return EncodedPairs(a->history).size() > EncodedPairs(b->history).size();
    });
    std::vector<const History*> histories;
    RowMajor actions(options.minibatch_size, kActionSize);
    RowMajor observations(options.minibatch_size, num_observations);
    RowMajor rewards(options.minibatch_size, 1);
    for (Eigen::Index r = 0; r < actions.rows(); ++r) {
      const Transition& transition = *drawn[static_cast<size_t>(r)];
      histories.push_back(&transition.history);
      actions.row(r) = NormalisedAction(transition.action).transpose();
      observations.row(r) =
          normalisation.Normalised(transition.next_observation).cast<float>().transpose();
      rewards(r, 0) = static_cast<float>(normalisation.Normalised(transition.reward));
      if (options.action_jitter == 0.0) continue;
      for (float& coefficient : actions.row(r)) {
        coefficient += static_cast<float>(options.action_jitter * rng.Normal());
      }
    }
    return {MakeBatch(histories), Copy(actions), Copy(observations), Copy(rewards)};
  }

  // One Adam step a minibatch. @return The mean of their losses, before each step.
  double TrainNetwork(RecurrentNetwork& network, const std::vector<Minibatch>& minibatches,
                      Tensor Minibatch::*target) const {
    const RecurrentNetwork::Layers& layers = network.trained();
    double sum = 0.0;
    for (const Minibatch& minibatch : minibatches) {
      const Tensor output = RecurrentNetwork::Output(
          layers, RecurrentNetwork::Encode(layers, minibatch.histories), minibatch.actions);
      const Tensor loss =
          (output - minibatch.*target).square().sum() / static_cast<double>(options.minibatch_size);
      loss.backward();
      network.Step(options.learning_rate);
      sum += loss.item<double>();
      if (!std::isfinite(sum)) break;
    }
    return sum / static_cast<double>(minibatches.size());
  }

  int num_observations;
  NetworkOptions options;
  double action_limit;
  Normalisation normalisation;
  RecurrentNetwork dynamics;
  RecurrentNetwork reward;
};

HistoryModel::HistoryModel(int observation_size, const NetworkOptions& options, double action_limit,
                           Rng& rng) {
  assert(observation_size > 0 && options.hidden_size > 0 && action_limit > 0.0);
  UseOneThread();
  impl_ = std::make_unique<Impl>(observation_size, options, action_limit, rng);
}
HistoryModel::~HistoryModel() = default;
HistoryModel::HistoryModel(HistoryModel&&) noexcept = default;
HistoryModel& HistoryModel::operator=(HistoryModel&&) noexcept = default;

int HistoryModel::observation_size() const { return impl_->num_observations; }
const NetworkOptions& HistoryModel::options() const { return impl_->options; }
const Normalisation& HistoryModel::normalisation() const { return impl_->normalisation; }

void HistoryModel::SetLearningRate(double learning_rate) {
  assert(learning_rate > 0.0);
  impl_->options.learning_rate = learning_rate;
}

void HistoryModel::SetNormalisation(const Normalisation& normalisation) {
  assert(normalisation.observation_mean.size() == impl_->num_observations);
  impl_->normalisation = normalisation;
}

TrainingLoss HistoryModel::Train(const ReplayMemory& memory, Rng& rng) {
  assert(memory.size() > 0);
  UseOneThread();
  std::vector<Minibatch> minibatches;
  for (int i = 0; i < impl_->options.minibatches_per_call; ++i) {
    minibatches.push_back(impl_->DrawMinibatch(memory, rng));
  }
  // The two networks know nothing of each other while they train: each on its own thread.
  const std::vector<double> losses = ParallelMap<double>(2, [&](size_t which) {
    UseOneThread();
    return which == 0 ? impl_->TrainNetwork(impl_->dynamics, minibatches, &Minibatch::observations)
                      : impl_->TrainNetwork(impl_->reward, minibatches, &Minibatch::rewards);
  });
  return {losses[0], losses[1]};
}

EncodedHistory HistoryModel::Encode(const History& history) const {
  assert(history.observations.size() == history.actions.size() + 1);
  UseOneThread();
  const torch::NoGradGuard no_gradients;
  const SequenceBatch batch = impl_->MakeBatch({&history});
  return {RowOf(RecurrentNetwork::Encode(impl_->dynamics.fixed(), batch)),
          RowOf(RecurrentNetwork::Encode(impl_->reward.fixed(), batch))};
}

StepPrediction HistoryModel::PredictStep(const EncodedHistory& history,
                                         const LoopCoefficients& action) const {
  UseOneThread();
  const torch::NoGradGuard no_gradients;
  const Tensor row = CopyAsRow(impl_->NormalisedAction(action));
  const Eigen::VectorXd observation =
      RowOf(RecurrentNetwork::Output(impl_->dynamics.fixed(), CopyAsRow(history.dynamics), row))
          .cast<double>();
  const double reward =
      RecurrentNetwork::Output(impl_->reward.fixed(), CopyAsRow(history.reward), row)
          .item<double>();
  const Normalisation& units = impl_->normalisation;
  return {units.observation_mean + units.observation_stddev.cwiseProduct(observation),
          units.reward_mean + units.reward_stddev * reward};
}

PredictedReturns HistoryModel::PredictReturns(const EncodedHistory& history,
                                              const Eigen::MatrixXd& actions,
                                              bool want_gradients) const {
  assert(actions.rows() > 0 && actions.rows() % kActionSize == 0);
  UseOneThread();
  const torch::AutoGradMode gradients(want_gradients);
  const RecurrentNetwork::Layers& dynamics = impl_->dynamics.fixed();
  const RecurrentNetwork::Layers& reward = impl_->reward.fixed();
  const Eigen::Index num_steps = actions.rows() / kActionSize;

  Tensor sequence = Copy((actions.transpose() / impl_->action_limit).cast<float>());
  sequence.set_requires_grad(want_gradients);
  Tensor dynamics_hidden = CopyAsRow(history.dynamics).expand({actions.cols(), -1});
  Tensor reward_hidden = CopyAsRow(history.reward).expand({actions.cols(), -1});
  Tensor sum = torch::zeros({actions.cols(), 1});
  for (Eigen::Index step = 0; step < num_steps; ++step) {
    const Tensor action = sequence.narrow(1, step * kActionSize, kActionSize);
    sum = sum + RecurrentNetwork::Output(reward, reward_hidden, action);
    if (step + 1 == num_steps) break;
    const Tensor observation =
        torch::clamp(RecurrentNetwork::Output(dynamics, dynamics_hidden, action),
                     -Normalisation::kCutOff, Normalisation::kCutOff);
    const Tensor pair = torch::cat({observation, action}, 1);
    reward_hidden = RecurrentNetwork::Advance(reward, pair, reward_hidden);
    // The last step needs no observation after it.
    if (step + 2 < num_steps) {
      dynamics_hidden = RecurrentNetwork::Advance(dynamics, pair, dynamics_hidden);
    }
  }

  const Normalisation& units = impl_->normalisation;
  PredictedReturns result;
  result.values = RowOf(sum.detach()).cast<double>() * units.reward_stddev;
  result.values.array() += units.reward_mean * static_cast<double>(num_steps);
  if (want_gradients) {
    // The particles don't interact: the gradient of their sum holds each one's own.
    sum.sum().backward();
    const Tensor gradient = sequence.grad().contiguous();
    result.gradients =
        Eigen::Map<const RowMajor>(gradient.data_ptr<float>(), gradient.size(0), gradient.size(1))
            .transpose()
            .cast<double>() *
        (units.reward_stddev / impl_->action_limit);
  }
  return result;
}

HistoryModel::State HistoryModel::state() const {
  return {impl_->normalisation, impl_->dynamics.numbers(), impl_->reward.numbers()};
}

void HistoryModel::Restore(const State& state) {
  SetNormalisation(state.normalisation);
  impl_->dynamics.Restore(state.dynamics);
  impl_->reward.Restore(state.reward);
}

size_t HistoryModel::num_dynamics_weights() const { return impl_->dynamics.size(); }
size_t HistoryModel::num_reward_weights() const { return impl_->reward.size(); }

}  // namespace calibrato
