#include "calibrato/learning/sac_agent.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calibrato {
namespace {

constexpr int kActionSize = LoopCoefficients::RowsAtCompileTime;
// The networks are small and their steps long: what counts is that few transitions are used up, and
// not learned by heart.
constexpr int kUnitsShare = 4;        // Of the hidden size of the model-based networks.
constexpr double kRateFactor = 10.0;  // Of their learning rate.
// Of the critics' actions, in limits. A return of four loops scatters by far more than any one of
// 36 coefficients can change it: critics that believe each slope that a few hundred transitions
// show promise twice what there is, and the policy follows them into corners. Noise on the actions
// shrinks slopes that are not sure (Bishop, "Training with noise is equivalent to Tikhonov
// regularization", 1995), and the least of several critics is believed.
constexpr double kActionNoise = 1.0;
constexpr int kNumCritics = 5;
constexpr double kTargetShare = 0.005;
constexpr double kMinLogStddev = -5.0;
constexpr double kMaxLogStddev = 1.0;
constexpr double kFloor = 1e-6;  // Of 1 - tanh^2, whose logarithm is taken.
constexpr double kWantedEntropy = -kActionSize;
constexpr double kFirstTemperature = 0.003;
constexpr double kTemperatureRate = 1e-3;

int NumUnits(const NetworkOptions& options) {
  return std::max(1, options.hidden_size / kUnitsShare);
}

int StateSize(int observation_size, int horizon) {
  return horizon + observation_size + kActionSize * (horizon - 1);
}

Eigen::MatrixXd Stacked(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd stacked(a.rows() + b.rows(), a.cols());
  stacked << a, b;
  return stacked;
}

Eigen::MatrixXd Noise(Eigen::Index columns, Rng& rng) {
  Eigen::MatrixXd noise(kActionSize, columns);
  for (double& x : noise.reshaped()) x = rng.Normal();
  return noise;
}

Eigen::MatrixXd LogStddev(const Eigen::MatrixXd& policy_output) {
  return policy_output.bottomRows(kActionSize).cwiseMax(kMinLogStddev).cwiseMin(kMaxLogStddev);
}

}  // namespace

// What the critics say of the same inputs.
struct SacAgent::Opinions {
  std::vector<Perceptron::Pass> passes;
  Eigen::RowVectorXd least;
  std::vector<size_t> whose;  // Of each column, the critic that says the least.
};

// Minibatches, one column a transition.
struct SacAgent::Batch {
  Eigen::MatrixXd states;
  Eigen::MatrixXd actions;  // In units of the limit.
  Eigen::RowVectorXd rewards;
  Eigen::MatrixXd next_states;
  Eigen::RowVectorXd goes_on;  // 0 where the episode ends, else 1.
};

SacAgent::SacAgent(const LearnOptions& options, int observation_size, int horizon, Rng rng)
    : options_(options.networks),
      limit_(options.planning.swarm.limit),
      horizon_(horizon),
      given_rate_(kRateFactor * options.networks.learning_rate),
      learning_rate_(given_rate_),
      normalisation_(UnitNormalisation(observation_size)),
      actor_(StateSize(observation_size, horizon), NumUnits(options_), 2 * kActionSize, rng),
      log_temperature_(std::log(kFirstTemperature)) {
  for (int i = 0; i < kNumCritics; ++i) {
    critics_.emplace_back(StateSize(observation_size, horizon) + kActionSize, NumUnits(options_), 1,
                          rng);
  }
  targets_ = critics_;
}

void SacAgent::BeginTraining(const ReplayMemory& memory) {
  normalisation_ = NormalisationOf(memory);
}

Eigen::VectorXd SacAgent::State(const History& history) const {
  const auto observation_size = normalisation_.observation_mean.size();
  Eigen::VectorXd state =
      Eigen::VectorXd::Zero(StateSize(static_cast<int>(observation_size), horizon_));
  const auto step = static_cast<Eigen::Index>(history.actions.size());
  // After the last step there is no state; nothing depends on what stands for it.
  state[std::min<Eigen::Index>(step, horizon_ - 1)] = 1.0;
  state.segment(horizon_, observation_size) =
      normalisation_.Normalised(history.observations.back());
  for (Eigen::Index k = 0; k < std::min<Eigen::Index>(step, horizon_ - 1); ++k) {
    state.segment<kActionSize>(horizon_ + observation_size + kActionSize * k) =
        history.actions[static_cast<size_t>(k)] / limit_;
  }
  return state;
}

SacAgent::Batch SacAgent::Draw(const ReplayMemory& memory, Rng& rng) const {
  Batch batch;
  const Eigen::Index n = options_.minibatch_size;
  const Eigen::Index state_size =
      StateSize(static_cast<int>(normalisation_.observation_mean.size()), horizon_);
  batch.states.resize(state_size, n);
  batch.next_states.resize(state_size, n);
  batch.actions.resize(kActionSize, n);
  batch.rewards.resize(n);
  batch.goes_on.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Transition& transition = memory[rng.UniformIndex(memory.size())];
    History next = transition.history;
    next.actions.push_back(transition.action);
    next.observations.push_back(transition.next_observation);
    batch.states.col(i) = State(transition.history);
    batch.next_states.col(i) = State(next);
    batch.actions.col(i) = transition.action / limit_;
    // Scaled but not shifted: an episode's return stays the sum of its rewards.
    batch.rewards[i] = transition.reward / normalisation_.reward_stddev;
    batch.goes_on[i] = static_cast<int>(next.actions.size()) < horizon_ ? 1.0 : 0.0;
  }
  return batch;
}

SacAgent::Sample SacAgent::SampleAt(const Eigen::MatrixXd& policy_output,
                                    const Eigen::MatrixXd& noise) const {
  const Eigen::MatrixXd log_stddev = LogStddev(policy_output);
  Sample sample;
  sample.action =
      (policy_output.topRows(kActionSize).array() + log_stddev.array().exp() * noise.array())
          .tanh();
  const Eigen::ArrayXXd squeeze = (1.0 - sample.action.array().square() + kFloor).log();
  sample.log_density = (-0.5 * noise.array().square() - log_stddev.array() -
                        0.5 * std::log(2.0 * std::numbers::pi) - squeeze)
                           .colwise()
                           .sum()
                           .transpose();
  return sample;
}

Eigen::MatrixXd SacAgent::SampleGradient(const Eigen::MatrixXd& policy_output,
                                         const Eigen::MatrixXd& noise, double temperature,
                                         const Eigen::MatrixXd& by_action) const {
  const Eigen::MatrixXd log_stddev = LogStddev(policy_output);
  const Eigen::ArrayXXd action = SampleAt(policy_output, noise).action;
  const Eigen::ArrayXXd slope = 1.0 - action.square();
  const Eigen::ArrayXXd by_mean =
      (by_action.array() + temperature * 2.0 * action / (slope + kFloor)) * slope;
  const auto raw = policy_output.bottomRows(kActionSize).array();
  const Eigen::ArrayXXd is_free = (raw > kMinLogStddev && raw < kMaxLogStddev).cast<double>();
  const Eigen::ArrayXXd by_log_stddev =
      (by_mean * log_stddev.array().exp() * noise.array() - temperature) * is_free;
  return Stacked(by_mean.matrix(), by_log_stddev.matrix());
}

SacAgent::Opinions SacAgent::Ask(const std::vector<Perceptron>& critics,
                                 const Eigen::MatrixXd& inputs) {
  Opinions opinions;
  for (const Perceptron& critic : critics) opinions.passes.push_back(critic.Forward(inputs));
  opinions.least = opinions.passes.front().output;
  opinions.whose.assign(static_cast<size_t>(inputs.cols()), 0);
  for (size_t k = 1; k < critics.size(); ++k) {
    for (Eigen::Index i = 0; i < inputs.cols(); ++i) {
      const double value = opinions.passes[k].output(0, i);
      if (!(value < opinions.least(i))) continue;
      opinions.least(i) = value;
      opinions.whose[static_cast<size_t>(i)] = k;
    }
  }
  return opinions;
}

double SacAgent::TrainCritics(const Batch& batch, Rng& rng) {
  const Eigen::Index n = batch.states.cols();
  const Sample next = SampleAt(actor_.Forward(batch.next_states).output, Noise(n, rng));
  const Eigen::MatrixXd next_inputs = Stacked(batch.next_states, next.action);
  const Eigen::RowVectorXd value =
      Ask(targets_, next_inputs).least - std::exp(log_temperature_) * next.log_density.transpose();
  const Eigen::RowVectorXd wanted = batch.rewards + batch.goes_on.cwiseProduct(value);
  const Eigen::MatrixXd inputs =
      Stacked(batch.states, batch.actions + kActionNoise * Noise(n, rng));
  double loss = 0.0;
  for (size_t i = 0; i < critics_.size(); ++i) {
    const Perceptron::Pass pass = critics_[i].Forward(inputs);
    const Eigen::RowVectorXd error = pass.output - wanted;
    (void)critics_[i].Backward(pass, 2.0 / static_cast<double>(n) * error);
    critics_[i].Step(learning_rate_);
    targets_[i].MoveTowards(critics_[i], kTargetShare);
    loss += error.squaredNorm() / static_cast<double>(kNumCritics * n);
  }
  return loss;
}

void SacAgent::TrainActor(const Batch& batch, Rng& rng) {
  const Eigen::Index n = batch.states.cols();
  const Perceptron::Pass pass = actor_.Forward(batch.states);
  const Eigen::MatrixXd noise = Noise(n, rng);
  const Sample sample = SampleAt(pass.output, noise);
  const Eigen::MatrixXd inputs = Stacked(batch.states, sample.action);
  // The slope of the critic that says the least, column by column.
  const Opinions opinions = Ask(critics_, inputs);
  Eigen::MatrixXd by_action = Eigen::MatrixXd::Zero(kActionSize, n);
  for (size_t k = 0; k < critics_.size(); ++k) {
    Eigen::RowVectorXd is_its = Eigen::RowVectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (opinions.whose[static_cast<size_t>(i)] == k) is_its(i) = 1.0;
    }
    by_action -= critics_[k].InputGradient(opinions.passes[k], is_its).bottomRows(kActionSize);
  }
  const Eigen::MatrixXd by_output =
      SampleGradient(pass.output, noise, std::exp(log_temperature_), by_action) /
      static_cast<double>(n);
  (void)actor_.Backward(pass, by_output);
  actor_.Step(learning_rate_);
  // Hotter while the entropy is below what is wanted.
  log_temperature_ -= kTemperatureRate * -(sample.log_density.mean() + kWantedEntropy);
  log_temperature_ = std::clamp(log_temperature_, -12.0, 2.0);
}

TrainingLoss SacAgent::Train(const ReplayMemory& memory, Rng& rng) {
  TrainingLoss loss;
  for (int i = 0; i < options_.minibatches_per_call; ++i) {
    const Batch batch = Draw(memory, rng);
    loss.reward += TrainCritics(batch, rng) / options_.minibatches_per_call;
    TrainActor(batch, rng);
  }
  return loss;
}

Decision SacAgent::Decide(int /*step*/, const History& history, Exploration exploration,
                          Rng& rng) const {
  const Eigen::VectorXd state = State(history);
  const Eigen::MatrixXd output = actor_.Forward(state).output;
  const Eigen::MatrixXd noise =
      exploration == Exploration::kTraining ? Noise(1, rng) : Eigen::MatrixXd::Zero(kActionSize, 1);
  const Eigen::MatrixXd action = SampleAt(output, noise).action;
  const Eigen::MatrixXd input = Stacked(state, action);
  Decision decision;
  decision.action = limit_ * action.col(0);
  decision.predicted_return = normalisation_.reward_stddev * Ask(critics_, input).least(0);
  return decision;
}

std::string SacAgent::Bytes() const {
  ByteWriter writer;
  writer.Write(normalisation_.observation_mean);
  writer.Write(normalisation_.observation_stddev);
  writer.Write(normalisation_.reward_mean);
  writer.Write(normalisation_.reward_stddev);
  writer.Write(log_temperature_);
  actor_.Write(writer);
  for (const Perceptron& critic : critics_) critic.Write(writer);
  for (const Perceptron& target : targets_) target.Write(writer);
  return writer.bytes();
}

bool SacAgent::Restore(std::string_view bytes, const std::string& path) {
  ByteReader reader(bytes, path);
  Normalisation normalisation;
  normalisation.observation_mean = reader.ReadVector();
  normalisation.observation_stddev = reader.ReadVector();
  normalisation.reward_mean = reader.ReadDouble();
  normalisation.reward_stddev = reader.ReadDouble();
  const double log_temperature = reader.ReadDouble();
  if (normalisation.observation_mean.size() != normalisation_.observation_mean.size()) return false;
  Perceptron actor = actor_;
  std::vector<Perceptron> critics = critics_;
  std::vector<Perceptron> targets = targets_;
  if (!actor.Read(reader)) return false;
  for (Perceptron& critic : critics) {
    if (!critic.Read(reader)) return false;
  }
  for (Perceptron& target : targets) {
    if (!target.Read(reader)) return false;
  }
  reader.ExpectEnd();
  normalisation_ = std::move(normalisation);
  log_temperature_ = log_temperature;
  actor_ = std::move(actor);
  critics_ = std::move(critics);
  targets_ = std::move(targets);
  return true;
}

}  // namespace calibrato
