#include "calibrato/learning/replay_memory.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

Transition WithReward(double reward) {
  return {
      {{Eigen::VectorXd::Zero(1)}, {}}, LoopCoefficients::Zero(), reward, Eigen::VectorXd::Zero(1)};
}

TEST(ReplayMemory, ForgetsTheOldestFirst) {
  ReplayMemory memory(3);
  for (const double reward : {1.0, 2.0, 3.0, 4.0, 5.0}) memory.Add(WithReward(reward));
  ASSERT_EQ(memory.size(), 3U);
  EXPECT_EQ(memory[0].reward, 3.0);
  EXPECT_EQ(memory[1].reward, 4.0);
  EXPECT_EQ(memory[2].reward, 5.0);
}

}  // namespace
}  // namespace calibrato
