#include "calibrato/learning/normalisation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace calibrato {
namespace {

ReplayMemory TwoTransitions() {
  ReplayMemory memory(10);
  memory.Add({{{Eigen::Vector2d(0.0, 7.0)}, {}},
              LoopCoefficients::Zero(),
              1.0,
              Eigen::Vector2d(2.0, 7.0)});
  memory.Add({{{Eigen::Vector2d(0.0, 7.0), Eigen::Vector2d(2.0, 7.0)}, {LoopCoefficients::Zero()}},
              LoopCoefficients::Zero(),
              5.0,
              Eigen::Vector2d(4.0, 7.0)});
  return memory;
}

TEST(NormalisationOf, TakesObservationsBeforeAndAfterEachStep) {
  const Normalisation normalisation = NormalisationOf(TwoTransitions());
  // First observation: 0, 2 and 2, 4, so mean 2 and mean square (4 + 0 + 0 + 4) / 4 = 2.
  EXPECT_DOUBLE_EQ(normalisation.observation_mean[0], 2.0);
  EXPECT_DOUBLE_EQ(normalisation.observation_stddev[0], std::sqrt(2.0));
  // Rewards 1 and 5.
  EXPECT_DOUBLE_EQ(normalisation.reward_mean, 3.0);
  EXPECT_DOUBLE_EQ(normalisation.reward_stddev, 2.0);
  EXPECT_DOUBLE_EQ(normalisation.Normalised(7.0), 2.0);
}

TEST(NormalisationOf, LeavesTheUnitOfWhatNeverVaried) {
  const Normalisation normalisation = NormalisationOf(TwoTransitions());
  EXPECT_EQ(normalisation.observation_stddev[1], 1.0);
  EXPECT_EQ(normalisation.Normalised(Eigen::VectorXd(Eigen::Vector2d(2.0, 7.5)))[1], 0.5);
}

TEST(Normalised, CutsOffWhatIsFarOutButNotNan) {
  const Normalisation normalisation = UnitNormalisation(3);
  const Eigen::VectorXd cut = normalisation.Normalised(
      Eigen::VectorXd(Eigen::Vector3d(1e6, -1e6, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_EQ(cut[0], 10.0);
  EXPECT_EQ(cut[1], -10.0);
  EXPECT_TRUE(std::isnan(cut[2]));
  EXPECT_EQ(normalisation.Normalised(-1e6), -10.0);
}

}  // namespace
}  // namespace calibrato
