#include "calibrato/learning/q_library_agent.h"

#include <gtest/gtest.h>

#include "calibrato/motion/motion.h"

namespace calibrato {
namespace {

TEST(MotionLibrary, ReachesTheLimitAndNoFarther) {
  const std::vector<LoopCoefficients> library = MotionLibrary(0.015);
  ASSERT_EQ(library.size(), 18U);
  for (const LoopCoefficients& loop : library) {
    EXPECT_NEAR(loop.cwiseAbs().maxCoeff(), 0.015, 1e-15);
  }
  for (size_t i = 0; i < library.size(); ++i) {
    for (size_t k = 0; k < i; ++k) EXPECT_FALSE(library[i].isApprox(library[k]));
  }
}

// Loop 3 first is worth nothing at once and 5 later; loop 4 is worth 1 at once.
TEST(QLibraryAgent, LooksBeyondTheNextReward) {
  LearnOptions options;
  QLibraryAgent agent(options, 2);
  const std::vector<LoopCoefficients> library = MotionLibrary(0.015);
  const Eigen::VectorXd y = Eigen::VectorXd::Zero(1);
  ReplayMemory memory(100);
  memory.Add({{{y}, {}}, library[3], 0.0, y});
  memory.Add({{{y}, {}}, library[4], 1.0, y});
  memory.Add({{{y, y}, {library[3]}}, library[7], 5.0, y});
  memory.Add({{{y, y}, {library[3]}}, library[8], -9.0, y});
  memory.Add({{{y, y}, {library[4]}}, library[7], 0.0, y});
  // An action of a random episode is in no library.
  memory.Add({{{y}, {}}, LoopCoefficients::Constant(0.001), 99.0, y});
  Rng rng(1);
  for (int i = 0; i < 10; ++i) (void)agent.Train(memory, rng);
  const Decision first = agent.Decide(0, {{y}, {}}, Exploration::kTesting, rng);
  EXPECT_EQ(first.action, library[3]);
  EXPECT_NEAR(*first.predicted_return, 5.0, 0.01);
  const Decision second = agent.Decide(1, {{y, y}, {library[3]}}, Exploration::kTesting, rng);
  EXPECT_EQ(second.action, library[7]);
  EXPECT_LT(agent.Train(memory, rng).reward, 0.01);
}

TEST(QLibraryAgent, TriesEverythingBeforeItSettles) {
  LearnOptions options;
  const QLibraryAgent agent(options, 1);
  const std::vector<LoopCoefficients> library = MotionLibrary(0.015);
  Rng rng(2);
  std::vector<int> counts(library.size());
  for (int i = 0; i < 400; ++i) {
    const Decision decision =
        agent.Decide(0, {{Eigen::VectorXd::Zero(1)}, {}}, Exploration::kTraining, rng);
    for (size_t k = 0; k < library.size(); ++k) counts[k] += decision.action == library[k];
  }
  for (const int count : counts) EXPECT_GT(count, 5);
}

TEST(QLibraryAgent, ComesBackFromItsBytes) {
  LearnOptions options;
  QLibraryAgent agent(options, 2);
  const Eigen::VectorXd y = Eigen::VectorXd::Zero(1);
  ReplayMemory memory(1);
  memory.Add({{{y, y}, {MotionLibrary(0.015)[2]}}, MotionLibrary(0.015)[1], 2.0, y});
  Rng rng(1);
  (void)agent.Train(memory, rng);
  QLibraryAgent copy(options, 2);
  EXPECT_TRUE(copy.Restore(agent.Bytes(), "bytes"));
  EXPECT_EQ(copy.Bytes(), agent.Bytes());
  QLibraryAgent longer(options, 3);
  EXPECT_FALSE(longer.Restore(agent.Bytes(), "bytes"));
}

}  // namespace
}  // namespace calibrato
