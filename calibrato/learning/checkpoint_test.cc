#include "calibrato/learning/checkpoint.h"

#include <gtest/gtest.h>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

Checkpoint SomeCheckpoint() {
  Checkpoint checkpoint;
  checkpoint.options = {{"seed", "1"}, {"task", "intrinsic"}};
  checkpoint.num_warm_up_episodes = 3;
  checkpoint.num_episodes_done = 7;
  checkpoint.num_calibrations = 26;
  checkpoint.best_return = 1.25;
  checkpoint.best_test_return = 1.125;
  checkpoint.best_test_actions = Eigen::MatrixXd::Constant(36, 2, 0.01);
  checkpoint.stage_episodes = {5, 6};
  checkpoint.num_rollbacks = 2;
  checkpoint.carried_over = Eigen::Vector2d(0.25, 3.5);
  checkpoint.agent = std::string("an agent\0with bytes", 19);
  checkpoint.replay_memory = ReplayMemory(5);
  const LoopCoefficients action = LoopCoefficients::LinSpaced(-1.0, 1.0);
  checkpoint.replay_memory.Add({{{Eigen::Vector2d(1, 2)}, {}}, action, 0.5, Eigen::Vector2d(3, 4)});
  checkpoint.replay_memory.Add({{{Eigen::Vector2d(1, 2), Eigen::Vector2d(3, 4)}, {action}},
                                -action,
                                -0.5,
                                Eigen::Vector2d(5, 6)});
  checkpoint.training_jsonl = "{\"episode\":1}\n";
  return checkpoint;
}

TEST(Checkpoint, ComesBackWhole) {
  const Checkpoint before = SomeCheckpoint();
  const Checkpoint after = CheckpointFromBytes(ToBytes(before), "checkpoint.bin");
  EXPECT_EQ(after.options, before.options);
  EXPECT_EQ(after.num_warm_up_episodes, 3);
  EXPECT_EQ(after.num_episodes_done, 7);
  EXPECT_EQ(after.num_calibrations, 26);
  EXPECT_EQ(after.best_return, 1.25);
  EXPECT_EQ(after.best_test_return, 1.125);
  EXPECT_EQ(after.best_test_actions, Eigen::MatrixXd::Constant(36, 2, 0.01));
  EXPECT_EQ(after.stage_episodes, (std::vector<int>{5, 6}));
  EXPECT_EQ(after.num_rollbacks, 2);
  EXPECT_EQ(after.carried_over, before.carried_over);
  EXPECT_EQ(after.agent, before.agent);
  EXPECT_EQ(after.replay_memory.capacity(), 5U);
  ASSERT_EQ(after.replay_memory.size(), 2U);
  EXPECT_EQ(after.replay_memory[1].history.actions[0], before.replay_memory[0].action);
  EXPECT_EQ(after.replay_memory[1].next_observation, Eigen::Vector2d(5, 6));
  EXPECT_EQ(after.training_jsonl, before.training_jsonl);
  EXPECT_EQ(ToBytes(after), ToBytes(before));
}

TEST(Checkpoint, IsRefusedWhenCutAnywhere) {
  const std::string bytes = ToBytes(SomeCheckpoint());
  for (size_t size = 0; size < bytes.size(); size += 13) {
    EXPECT_THROW((void)CheckpointFromBytes(bytes.substr(0, size), "checkpoint.bin"), InputError);
  }
}

}  // namespace
}  // namespace calibrato
