#include "calibrato/learning/networks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace calibrato {
namespace {

constexpr double kLimit = 0.015;

LoopCoefficients RandomAction(Rng& rng) {
  LoopCoefficients action;
  for (double& coefficient : action) coefficient = rng.Uniform(-kLimit, kLimit);
  return action;
}

History RandomHistory(int num_actions, int observation_size, Rng& rng) {
  const auto observation = [&] {
    Eigen::VectorXd y(observation_size);
    for (double& x : y) x = rng.Normal();
    return y;
  };
  History history{{observation()}, {}};
  for (int k = 0; k < num_actions; ++k) {
    history.actions.push_back(RandomAction(rng));
    history.observations.push_back(observation());
  }
  return history;
}

// What is there to learn: the reward asks for this step's action and for the episode's first one.
Transition Learnable(int num_actions, Rng& rng) {
  Transition transition;
  transition.history = RandomHistory(num_actions, 2, rng);
  transition.action = RandomAction(rng);
  const double first = num_actions > 0 ? transition.history.actions.front()[0] / kLimit : 0.0;
  transition.reward = transition.action[3] / kLimit + first;
  transition.next_observation = transition.history.observations.back();
  transition.next_observation[0] += transition.action[1] / kLimit;
  return transition;
}

ReplayMemory LearnableMemory(int num_transitions) {
  Rng rng(11);
  ReplayMemory memory(1000);
  for (int i = 0; i < num_transitions; ++i) memory.Add(Learnable(i % 3, rng));
  return memory;
}

// Without jitter: what they learn is exact.
NetworkOptions SmallNetworks() {
  NetworkOptions options;
  options.action_jitter = 0.0;
  options.hidden_size = 16;
  options.learning_rate = 3e-3;
  return options;
}

HistoryModel SmallModel(int observation_size = 2) {
  Rng rng(5);
  return {observation_size, SmallNetworks(), kLimit, rng};
}

// Figure 2 of the paper in double precision, from the list of weights.
class PlainNetwork {
 public:
  PlainNetwork(const NetworkWeights& numbers, int pair_size, int hidden_size, int output_size)
      : numbers_(numbers), n_(hidden_size) {
    input_ = Next(3 * n_, pair_size);
    input_bias_ = Next(3 * n_, 1);
    recurrent_ = Next(3 * n_, n_);
    recurrent_bias_ = Next(3 * n_, 1);
    action_ = Next(n_, 36);
    action_bias_ = Next(n_, 1);
    joint_ = Next(n_, 2 * n_);
    joint_bias_ = Next(n_, 1);
    output_ = Next(output_size, n_);
    output_bias_ = Next(output_size, 1);
  }

  [[nodiscard]] Eigen::VectorXd Encode(const History& history) const {
    Eigen::VectorXd h = Eigen::VectorXd::Zero(n_);
    for (size_t k = 0; k < history.observations.size(); ++k) {
      Eigen::VectorXd pair(history.observations[k].size() + 36);
      pair << history.observations[k],
          (k > 0 ? LoopCoefficients(history.actions[k - 1] / kLimit) : LoopCoefficients::Zero());
      const Eigen::VectorXd a = input_ * pair + input_bias_;
      const Eigen::VectorXd b = recurrent_ * h + recurrent_bias_;
      for (int i = 0; i < n_; ++i) {
        const double reset = Sigmoid(a[i] + b[i]);
        const double update = Sigmoid(a[n_ + i] + b[n_ + i]);
        const double candidate = std::tanh(a[2 * n_ + i] + reset * b[2 * n_ + i]);
        h[i] = (1.0 - update) * candidate + update * h[i];
      }
    }
    return h;
  }

  [[nodiscard]] Eigen::VectorXd Output(const Eigen::VectorXd& hidden,
                                       const LoopCoefficients& action) const {
    Eigen::VectorXd both(2 * n_);
    both << hidden, action_ * (action / kLimit) + action_bias_;
    return output_ * (joint_ * both + joint_bias_).cwiseMax(0.0) + output_bias_;
  }

 private:
  static double Sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }
  Eigen::MatrixXd Next(int rows, int cols) {
    Eigen::MatrixXd matrix(rows, cols);
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < cols; ++j) matrix(i, j) = numbers_.weights[position_++];
    }
    return matrix;
  }
  const NetworkWeights& numbers_;
  size_t position_ = 0;
  int n_;
  Eigen::MatrixXd input_, recurrent_, action_, joint_, output_;
  Eigen::VectorXd input_bias_, recurrent_bias_, action_bias_, joint_bias_, output_bias_;
};

TEST(HistoryModel, ComputesFigureTwoOfThePaper) {
  const HistoryModel model = SmallModel();
  const HistoryModel::State state = model.state();
  const PlainNetwork dynamics(state.dynamics, 38, 16, 2);
  const PlainNetwork reward(state.reward, 38, 16, 1);
  Rng rng(1);
  for (const int num_actions : {0, 1, 3}) {
    const History history = RandomHistory(num_actions, 2, rng);
    const LoopCoefficients action = RandomAction(rng);
    const StepPrediction predicted = model.PredictStep(model.Encode(history), action);
    EXPECT_LT(
        (predicted.next_observation - dynamics.Output(dynamics.Encode(history), action)).norm(),
        1e-5);
    EXPECT_NEAR(predicted.reward, reward.Output(reward.Encode(history), action)[0], 1e-5);
  }
}

TEST(HistoryModel, PredictsInTheUnitsOfTheEnvironment) {
  HistoryModel model = SmallModel();
  Rng rng(1);
  const History history = RandomHistory(0, 2, rng);
  const LoopCoefficients action = RandomAction(rng);
  const StepPrediction plain = model.PredictStep(model.Encode(history), action);

  Normalisation units;
  units.observation_mean = Eigen::Vector2d(100.0, -5.0);
  units.observation_stddev = Eigen::Vector2d(10.0, 0.5);
  units.reward_mean = -3.0;
  units.reward_stddev = 2.0;
  model.SetNormalisation(units);
  History scaled = history;
  scaled.observations[0] =
      units.observation_mean + units.observation_stddev.cwiseProduct(history.observations[0]);
  const StepPrediction prediction = model.PredictStep(model.Encode(scaled), action);
  EXPECT_NEAR(prediction.reward, -3.0 + 2.0 * plain.reward, 1e-5);
  EXPECT_NEAR(prediction.next_observation[0], 100.0 + 10.0 * plain.next_observation[0], 1e-4);
}

TEST(PredictReturns, IsTheSumOfStepsWhoseObservationsArePredicted) {
  HistoryModel model = SmallModel();
  Normalisation units = UnitNormalisation(2);
  units.observation_stddev = Eigen::Vector2d(3.0, 0.5);
  units.reward_mean = 0.7;
  units.reward_stddev = 4.0;
  model.SetNormalisation(units);
  Rng rng(2);
  const History start = RandomHistory(1, 2, rng);
  Eigen::MatrixXd actions(36 * 3, 2);
  for (double& a : actions.reshaped()) a = rng.Uniform(-kLimit, kLimit);
  const PredictedReturns predicted = model.PredictReturns(model.Encode(start), actions, false);
  for (Eigen::Index i = 0; i < actions.cols(); ++i) {
    History history = start;
    double sum = 0.0;
    for (int step = 0; step < 3; ++step) {
      const LoopCoefficients action = actions.col(i).segment<36>(36 * step);
      const StepPrediction next = model.PredictStep(model.Encode(history), action);
      sum += next.reward;
      history.actions.push_back(action);
      history.observations.push_back(next.next_observation);
    }
    EXPECT_NEAR(predicted.values[i], sum, 1e-4);
  }
}

void ExpectGradientMatchesDifferences(const HistoryModel& model, int num_steps) {
  Rng rng(3);
  const EncodedHistory history = model.Encode(RandomHistory(1, model.observation_size(), rng));
  Eigen::MatrixXd actions(36 * num_steps, 3);
  for (double& a : actions.reshaped()) a = rng.Uniform(-kLimit, kLimit);
  const Eigen::MatrixXd gradients = model.PredictReturns(history, actions, true).gradients;
  ASSERT_EQ(gradients.rows(), actions.rows());
  ASSERT_EQ(gradients.cols(), actions.cols());
  // A short step, since hundreds of relus have a corner within a longer one. Values near 1 have a
  // rounding error of 1e-7, over twice the step that is 0.005 of gradients near 10.
  constexpr double kStep = 1e-5;
  Eigen::MatrixXd differences(actions.rows(), actions.cols());
  for (Eigen::Index k = 0; k < actions.rows(); ++k) {
    Eigen::MatrixXd moved = actions;
    moved.row(k).array() += kStep;
    const Eigen::VectorXd after = model.PredictReturns(history, moved, false).values;
    moved.row(k).array() -= 2.0 * kStep;
    const Eigen::VectorXd before = model.PredictReturns(history, moved, false).values;
    differences.row(k) = (after - before).transpose() / (2.0 * kStep);
  }
  EXPECT_GT(gradients.norm(), 1.0);
  EXPECT_LT((gradients - differences).norm(), 0.03 * gradients.norm());
}

TEST(PredictReturns, HasTheGradientOfItsValue) {
  HistoryModel model = SmallModel();
  Normalisation units = UnitNormalisation(2);
  units.reward_stddev = 4.0;
  model.SetNormalisation(units);
  ExpectGradientMatchesDifferences(model, 3);
}

TEST(PredictReturns, HasTheGradientOfItsValueAtThePapersSize) {
  Rng rng(6);
  HistoryModel model(8, NetworkOptions(), kLimit, rng);
  Normalisation units = UnitNormalisation(8);
  units.reward_stddev = 10.0;
  model.SetNormalisation(units);
  ExpectGradientMatchesDifferences(model, 2);
}

TEST(PredictReturns, LeavesTheWeightsGradientsAlone) {
  const ReplayMemory memory = LearnableMemory(40);
  HistoryModel with = SmallModel();
  HistoryModel without = SmallModel();
  Rng rng(3);
  (void)with.PredictReturns(with.Encode(RandomHistory(1, 2, rng)), Eigen::MatrixXd::Zero(72, 3),
                            true);
  Rng rng_with(4);
  Rng rng_without(4);
  (void)with.Train(memory, rng_with);
  (void)without.Train(memory, rng_without);
  EXPECT_EQ(with.state().reward.weights, without.state().reward.weights);
}

// Loss of one network on one transition, by the oracle above.
double PlainLoss(const NetworkWeights& weights, const Transition& transition, int output_size) {
  const PlainNetwork network(weights, 38, 4, output_size);
  const Eigen::VectorXd output =
      network.Output(network.Encode(transition.history), transition.action);
  const Eigen::VectorXd target = output_size == 1 ? Eigen::VectorXd::Constant(1, transition.reward)
                                                  : Eigen::VectorXd(transition.next_observation);
  return (output - target).squaredNorm();
}

void ExpectStepDownhill(const NetworkWeights& before, const NetworkWeights& after,
                        const Transition& transition, int output_size, double rate) {
  // Adam's first step has length `rate` along every weight's own sign, whatever the gradient's
  // size.
  int num_compared = 0;
  for (size_t i = 0; i < before.weights.size(); ++i) {
    NetworkWeights moved = before;
    constexpr float kStep = 1e-3F;
    moved.weights[i] += kStep;
    const double up = PlainLoss(moved, transition, output_size);
    moved.weights[i] = before.weights[i] - kStep;
    const double down = PlainLoss(moved, transition, output_size);
    const double slope = (up - down) / (2.0 * kStep);
    const double change = after.weights[i] - before.weights[i];
    if (std::abs(slope) < 1e-4) continue;
    ++num_compared;
    EXPECT_NEAR(change, slope > 0.0 ? -rate : rate, 0.02 * rate) << "weight " << i;
  }
  EXPECT_GT(num_compared, static_cast<int>(before.weights.size()) / 4);
}

TEST(Train, StepsDownTheGradientOfEquationsFourAndFive) {
  for (const int num_actions : {0, 2}) {
    NetworkOptions options;
    options.hidden_size = 4;
    options.minibatches_per_call = 1;
    options.action_jitter = 0.0;
    Rng weights_rng(5);
    HistoryModel model(2, options, kLimit, weights_rng);
    Rng rng(12);
    ReplayMemory memory(1);
    memory.Add(Learnable(num_actions, rng));
    const HistoryModel::State before = model.state();
    const TrainingLoss loss = model.Train(memory, rng);
    const HistoryModel::State after = model.state();
    EXPECT_NEAR(loss.dynamics, PlainLoss(before.dynamics, memory[0], 2), 1e-4);
    EXPECT_NEAR(loss.reward, PlainLoss(before.reward, memory[0], 1), 1e-4);
    ExpectStepDownhill(before.dynamics, after.dynamics, memory[0], 2, 1e-4);
    ExpectStepDownhill(before.reward, after.reward, memory[0], 1, 1e-4);
  }
}

// Rewards that have nothing to do with the action: whatever slope a network finds was learned by
// heart.
TEST(Train, JitterKeepsNetworksFromInventingSlopes) {
  Rng rng(21);
  ReplayMemory memory(60);
  for (int i = 0; i < 60; ++i) {
    Transition transition = Learnable(0, rng);
    transition.reward = rng.Normal();
    memory.Add(transition);
  }
  const auto mean_slope = [&](double jitter) {
    NetworkOptions options = SmallNetworks();
    options.action_jitter = jitter;
    Rng weights_rng(5);
    HistoryModel model(2, options, kLimit, weights_rng);
    Rng training_rng(22);
    for (int i = 0; i < 150; ++i) (void)model.Train(memory, training_rng);
    Rng action_rng(23);
    Eigen::MatrixXd actions(36, 20);
    for (Eigen::Index k = 0; k < actions.cols(); ++k) actions.col(k) = RandomAction(action_rng);
    return model.PredictReturns(model.Encode(memory[0].history), actions, true)
        .gradients.colwise()
        .norm()
        .mean();
  };
  EXPECT_LT(mean_slope(0.5), 0.5 * mean_slope(0.0));
}

TEST(Train, LearnsFromTheActionAndFromTheHistoryOfEveryLength) {
  const ReplayMemory memory = LearnableMemory(1000);
  HistoryModel model = SmallModel();
  model.SetNormalisation(NormalisationOf(memory));
  Rng rng(4);
  const TrainingLoss first = model.Train(memory, rng);
  TrainingLoss last;
  for (int i = 0; i < 100; ++i) last = model.Train(memory, rng);
  EXPECT_LT(last.dynamics, 0.1 * first.dynamics);
  EXPECT_LT(last.reward, 0.1 * first.reward);
  // Fresh data, two steps after the first action: without the history the error's variance would be
  // 1/3, that of the first action's part.
  Rng fresh(77);
  double squares = 0.0;
  for (int i = 0; i < 200; ++i) {
    const Transition t = Learnable(2, fresh);
    squares += std::pow(model.PredictStep(model.Encode(t.history), t.action).reward - t.reward, 2);
  }
  EXPECT_LT(squares / 200, 0.15);
}

TEST(Train, GivesTheSameBytesForTheSameSeed) {
  const ReplayMemory memory = LearnableMemory(40);
  std::vector<HistoryModel::State> states;
  for (int run = 0; run < 2; ++run) {
    HistoryModel model = SmallModel();
    Rng rng(4);
    for (int i = 0; i < 3; ++i) (void)model.Train(memory, rng);
    states.push_back(model.state());
  }
  EXPECT_EQ(states[0].dynamics.weights, states[1].dynamics.weights);
  EXPECT_EQ(states[0].reward.second_moment, states[1].reward.second_moment);
}

TEST(Restore, ContinuesTrainingAsIfNeverStopped) {
  const ReplayMemory memory = LearnableMemory(40);
  HistoryModel model = SmallModel();
  model.SetNormalisation(NormalisationOf(memory));
  Rng rng(4);
  (void)model.Train(memory, rng);
  Rng other_rng(99);
  HistoryModel other(2, SmallNetworks(), kLimit, other_rng);
  other.Restore(model.state());
  Rng rng_copy = rng;
  (void)model.Train(memory, rng);
  (void)other.Train(memory, rng_copy);
  EXPECT_EQ(model.state().dynamics.weights, other.state().dynamics.weights);
  EXPECT_EQ(model.state().reward.weights, other.state().reward.weights);
}

TEST(Train, ReturnsALossThatIsNotFinite) {
  ReplayMemory memory = LearnableMemory(4);
  Transition broken = memory[0];
  broken.next_observation[0] = std::nan("");
  memory = ReplayMemory(1);
  memory.Add(broken);
  HistoryModel model = SmallModel();
  Rng rng(4);
  EXPECT_FALSE(std::isfinite(model.Train(memory, rng).dynamics));
}

// The original's mask: what is left of a history may be nothing.
TEST(MaskedHistories, SkipTheFirstPairAndThoseWithoutACalibration) {
  NetworkOptions options;
  options.hidden_size = 8;
  options.mask_histories = true;
  Rng rng(4);
  const HistoryModel model(2, options, 0.015, rng);
  const Eigen::Vector2d start(0.5, -0.5);
  const Eigen::Vector2d later(1.5, 0.25);
  const LoopCoefficients action = LoopCoefficients::Constant(0.01);
  const EncodedHistory first = model.Encode({{start}, {}});
  EXPECT_EQ(first.dynamics, Eigen::VectorXf::Zero(8));
  EXPECT_EQ(first.reward, Eigen::VectorXf::Zero(8));
  // Without a calibration every step is skipped, whatever was done.
  EXPECT_EQ(model.Encode({{start, start, start}, {action, -action}}).reward, first.reward);
  // With one, only what came before it.
  const EncodedHistory seen = model.Encode({{start, later}, {action}});
  EXPECT_NE(seen.reward, first.reward);
  EXPECT_EQ(model.Encode({{start, start, later}, {-action, action}}).reward, seen.reward);

  options.mask_histories = false;
  Rng same(4);
  const HistoryModel whole(2, options, 0.015, same);
  EXPECT_NE(whole.Encode({{start}, {}}).reward, first.reward);
}

TEST(MaskedHistories, AreTrainedOnTogetherWithEmptyOnes) {
  NetworkOptions options;
  options.hidden_size = 8;
  options.mask_histories = true;
  options.learning_rate = 1e-2;
  Rng rng(5);
  HistoryModel model(2, options, 0.015, rng);
  const Eigen::Vector2d start(0.0, 0.0);
  const Eigen::Vector2d later(1.0, -1.0);
  const LoopCoefficients action = LoopCoefficients::Constant(0.01);
  ReplayMemory memory(10);
  memory.Add({{{start}, {}}, action, 1.0, later});
  memory.Add({{{start, later}, {action}}, action, -1.0, start});
  memory.Add({{{start, start}, {action}}, -action, 0.5, start});
  const TrainingLoss before = model.Train(memory, rng);
  TrainingLoss after;
  for (int i = 0; i < 40; ++i) after = model.Train(memory, rng);
  EXPECT_LT(after.dynamics, 0.7 * before.dynamics);
  EXPECT_LT(after.reward, 0.7 * before.reward);
}

TEST(HistoryModel, TakesSmallerStepsAtASmallerLearningRate) {
  NetworkOptions options;
  options.hidden_size = 8;
  const auto step = [&](double learning_rate) {
    Rng rng(6);
    HistoryModel model(1, options, 0.015, rng);
    model.SetLearningRate(learning_rate);
    ReplayMemory memory(1);
    memory.Add({{{Eigen::VectorXd::Zero(1)}, {}},
                LoopCoefficients::Zero(),
                1.0,
                Eigen::VectorXd::Ones(1)});
    const std::vector<float> before = model.state().reward.weights;
    (void)model.Train(memory, rng);
    const std::vector<float> after = model.state().reward.weights;
    float largest = 0.0F;
    for (size_t i = 0; i < before.size(); ++i) {
      largest = std::max(largest, std::abs(after[i] - before[i]));
    }
    return largest;
  };
  EXPECT_NEAR(step(1e-5) / step(1e-4), 0.1, 0.05);
}

}  // namespace
}  // namespace calibrato
