#include "calibrato/learning/policy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::string FreshFolder(const std::string& name) {
  const std::string folder = testing::TempDir() + "calibrato_policy_" + name;
  std::filesystem::remove_all(folder);
  return folder;
}

Policy SomePolicy() {
  Policy policy;
  policy.task = Task::kExtrinsic;
  policy.preset = "paper";
  policy.stage = "fine-tuned";
  policy.mistakes = "masked-histories";
  policy.seed = 0xfffffffffffffff0U;
  policy.num_episodes = 12;
  policy.horizon = 2;
  policy.observation_size = 3;
  policy.networks.hidden_size = 8;
  policy.networks.mask_histories = true;
  policy.planning.planner = "icem";
  policy.planning.swarm.num_particles = 7;
  Rng rng(1);
  HistoryModel model(3, policy.networks, policy.planning.swarm.limit, rng);
  Normalisation units = UnitNormalisation(3);
  units.observation_mean = Eigen::Vector3d(0.1, 2.0, -1e-7);
  units.reward_stddev = 2.5;
  model.SetNormalisation(units);
  policy.model = model.state();
  policy.particle_memory = {Eigen::MatrixXd::Constant(72, 5, 0.01), Eigen::MatrixXd(36, 0)};
  policy.motion.loops = {{LoopCoefficients::LinSpaced(-0.01, 0.03), 5.0}};
  return policy;
}

TEST(Policy, ComesBackWhole) {
  const std::string folder = FreshFolder("whole");
  const Policy before = SomePolicy();
  WritePolicy(before, folder);
  const Policy after = ReadPolicy(folder);
  EXPECT_EQ(after.task, Task::kExtrinsic);
  EXPECT_EQ(after.preset, "paper");
  EXPECT_EQ(after.stage, "fine-tuned");
  EXPECT_EQ(after.mistakes, "masked-histories");
  EXPECT_TRUE(after.networks.mask_histories);
  EXPECT_EQ(after.planning.planner, "icem");
  EXPECT_FALSE(after.planning.swarm.frozen);
  EXPECT_EQ(after.seed, before.seed);
  EXPECT_EQ(after.num_episodes, 12);
  EXPECT_EQ(after.horizon, 2);
  EXPECT_EQ(after.planning.swarm.num_particles, 7);
  EXPECT_EQ(after.planning.swarm.gradient_weight, 1e-4);
  EXPECT_EQ(after.model.dynamics.weights, before.model.dynamics.weights);
  EXPECT_EQ(after.model.reward.weights, before.model.reward.weights);
  EXPECT_EQ(after.model.normalisation.observation_mean, Eigen::Vector3d(0.1, 2.0, -1e-7));
  EXPECT_EQ(after.particle_memory[0], before.particle_memory[0]);
  ASSERT_EQ(after.motion.loops.size(), 1U);
  EXPECT_EQ(after.motion.loops[0].coefficients, before.motion.loops[0].coefficients);

  Rng rng(1);
  HistoryModel model(3, before.networks, before.planning.swarm.limit, rng);
  model.Restore(before.model);
  const History history{{Eigen::Vector3d(1.0, 2.0, 3.0)}, {}};
  const HistoryModel loaded = ModelOf(after);
  EXPECT_EQ(loaded.PredictStep(loaded.Encode(history), LoopCoefficients::Zero()).reward,
            model.PredictStep(model.Encode(history), LoopCoefficients::Zero()).reward);
}

TEST(ReadPolicy, NamesBothVersions) {
  const std::string folder = FreshFolder("version");
  WritePolicy(SomePolicy(), folder);
  std::string text = ReadFile(folder + "/policy.yaml");
  const std::string now = "format_version: 2";
  ASSERT_NE(text.find(now), std::string::npos);
  text.replace(text.find(now), now.size(), "format_version: 9");
  WriteFileAtomically(folder + "/policy.yaml", text);
  EXPECT_THAT([&] { (void)ReadPolicy(folder); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("policy.yaml"), HasSubstr("version 9"), HasSubstr("version 2"))));
}

TEST(ReadPolicy, RefusesWeightsThatAreDamagedOrOfAnotherNetwork) {
  const std::string folder = FreshFolder("damaged");
  WritePolicy(SomePolicy(), folder);
  std::string bytes = ReadFile(folder + "/policy.bin");
  bytes[bytes.size() / 2] ^= 1;
  WriteFileAtomically(folder + "/policy.bin", bytes);
  EXPECT_THAT([&] { (void)ReadPolicy(folder); }, ThrowsMessage<InputError>(HasSubstr("damaged")));

  Policy other = SomePolicy();
  WritePolicy(other, folder);
  const std::string small = ReadFile(folder + "/policy.bin");
  other.networks.hidden_size = 9;
  Rng rng(1);
  other.model = HistoryModel(3, other.networks, other.planning.swarm.limit, rng).state();
  WritePolicy(other, folder);
  WriteFileAtomically(folder + "/policy.bin", small);
  EXPECT_THAT([&] { (void)ReadPolicy(folder); },
              ThrowsMessage<InputError>(HasSubstr("policy.yaml")));
}

TEST(ReadPolicy, NamesAMissingFile) {
  const std::string folder = FreshFolder("missing");
  WritePolicy(SomePolicy(), folder);
  std::filesystem::remove(folder + "/policy.bin");
  EXPECT_THAT([&] { (void)ReadPolicy(folder); },
              ThrowsMessage<InputError>(HasSubstr("policy.bin")));
}

}  // namespace
}  // namespace calibrato
