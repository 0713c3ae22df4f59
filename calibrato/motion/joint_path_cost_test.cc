#include "calibrato/motion/joint_path_cost.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

JointVector Middle() { return 0.5 * (Limits().lower + Limits().upper); }

TEST(JointLimitExcess, IsNegativeInsideAndCountsTheWorstJoint) {
  EXPECT_LT(JointLimitExcess(Middle()), 0.0);
  JointVector q = Middle();
  q[3] = Limits().lower[3] - 0.2;
  q[5] = Limits().upper[5] + 0.1;
  EXPECT_NEAR(JointLimitExcess(q), 0.2, 1e-12);
}

TEST(JointPathCost, WallStandsOnlyBeforeTheLimits) {
  const JointPathCost cost{.margin = 0.1, .weight = 50.0};
  EXPECT_EQ(cost.Wall(Middle()), 0.0);
  JointVector q = Middle();
  q[1] = Limits().upper[1] - 0.04;  // 0.06 into the wall
  EXPECT_NEAR(cost.Wall(q), 0.5 * 50.0 * 0.06 * 0.06, 1e-12);
}

TEST(JointPathCost, DerivativesAgreeWithDifferences) {
  const JointPathCost cost{.margin = 0.1, .weight = 50.0};
  JointVector q = Middle();
  q[1] = Limits().upper[1] - 0.04;
  q[3] = Limits().lower[3] - 0.03;
  const double step = 1e-5;
  for (int i = 0; i < 7; ++i) {
    const JointVector after = q + step * JointVector::Unit(i);
    const JointVector before = q - step * JointVector::Unit(i);
    EXPECT_NEAR(cost.WallGradient(q)[i], (cost.Wall(after) - cost.Wall(before)) / (2.0 * step),
                1e-8);
    EXPECT_NEAR(cost.WallCurvature(q)[i],
                (cost.WallGradient(after)[i] - cost.WallGradient(before)[i]) / (2.0 * step), 1e-6);
  }
}

}  // namespace
}  // namespace calibrato
