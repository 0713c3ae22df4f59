#include "calibrato/learning/sac_agent.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace calibrato {
namespace {

LearnOptions SmallOptions() {
  LearnOptions options;
  options.planning.planner = "sac";
  options.networks.hidden_size = 64;
  options.networks.learning_rate = 3e-4;
  return options;
}

Eigen::MatrixXd RandomMatrix(Eigen::Index rows, Eigen::Index columns, Rng& rng) {
  Eigen::MatrixXd matrix(rows, columns);
  for (double& x : matrix.reshaped()) x = 0.5 * rng.Normal();
  return matrix;
}

TEST(SacAgent, KnowsTheDensityOfItsActions) {
  const SacAgent agent(SmallOptions(), 2, 2, Rng(1));
  // Mean 0, standard deviation 1, noise 0 but for one coordinate: tanh(0.3), of density
  // phi(0.3) / (1 - tanh(0.3)^2).
  const Eigen::MatrixXd output = Eigen::MatrixXd::Zero(72, 1);
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(36, 1);
  noise(4) = 0.3;
  const SacAgent::Sample sample = agent.SampleAt(output, noise);
  EXPECT_NEAR(sample.action(4), std::tanh(0.3), 1e-12);
  const double normal = -18.0 * std::log(2.0 * std::numbers::pi) - 0.045;
  EXPECT_NEAR(sample.log_density(0), normal - std::log(1.0 - std::pow(std::tanh(0.3), 2)), 1e-4);
}

TEST(SacAgent, HasTheGradientOfItsPolicy) {
  const SacAgent agent(SmallOptions(), 2, 2, Rng(1));
  Rng rng(2);
  const Eigen::MatrixXd output = RandomMatrix(72, 2, rng);
  const Eigen::MatrixXd noise = RandomMatrix(36, 2, rng);
  const Eigen::MatrixXd by_action = RandomMatrix(36, 2, rng);
  constexpr double kTemperature = 0.7;
  const auto loss = [&](const Eigen::MatrixXd& o) {
    const SacAgent::Sample sample = agent.SampleAt(o, noise);
    return kTemperature * sample.log_density.sum() + by_action.cwiseProduct(sample.action).sum();
  };
  const Eigen::MatrixXd gradient = agent.SampleGradient(output, noise, kTemperature, by_action);
  constexpr double kStep = 1e-6;
  for (Eigen::Index i = 0; i < output.size(); ++i) {
    Eigen::MatrixXd moved = output;
    moved.reshaped()[i] += kStep;
    const double above = loss(moved);
    moved.reshaped()[i] -= 2.0 * kStep;
    EXPECT_NEAR((above - loss(moved)) / (2.0 * kStep), gradient.reshaped()[i], 1e-6);
  }
}

// One step, the reward is the first coefficient: the policy goes to its limit, and the critic knows
// what it is worth.
TEST(SacAgent, ClimbsARewardThatItSees) {
  LearnOptions options = SmallOptions();
  SacAgent agent(options, 1, 1, Rng(3));
  ReplayMemory memory(200);
  Rng rng(4);
  const Eigen::VectorXd observation = Eigen::VectorXd::Zero(1);
  for (int i = 0; i < 200; ++i) {
    LoopCoefficients action;
    for (double& a : action) a = rng.Uniform(-0.015, 0.015);
    memory.Add({{{observation}, {}}, action, action[0] / 0.015, observation});
  }
  agent.BeginTraining(memory);
  const History start{{observation}, {}};
  for (int i = 0; i < 60; ++i) (void)agent.Train(memory, rng);
  const Decision decision = agent.Decide(0, start, Exploration::kTesting, rng);
  EXPECT_GT(decision.action[0], 0.008);
  EXPECT_LE(decision.action.cwiseAbs().maxCoeff(), 0.015);
  EXPECT_NEAR(*decision.predicted_return, decision.action[0] / 0.015, 0.4);
}

TEST(SacAgent, TellsBytesOfAnotherSize) {
  const SacAgent agent(SmallOptions(), 2, 2, Rng(1));
  SacAgent longer(SmallOptions(), 2, 3, Rng(1));
  SacAgent same(SmallOptions(), 2, 2, Rng(5));
  EXPECT_FALSE(longer.Restore(agent.Bytes(), "bytes"));
  EXPECT_TRUE(same.Restore(agent.Bytes(), "bytes"));
  EXPECT_EQ(same.Bytes(), agent.Bytes());
}

}  // namespace
}  // namespace calibrato
