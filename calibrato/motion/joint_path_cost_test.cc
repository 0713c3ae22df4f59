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

JointVector InTwoWalls() {
  JointVector q = Middle();
  q[1] = Limits().upper[1] - 0.04;
  q[3] = Limits().lower[3] - 0.03;
  return q;
}

TEST(JointPathCost, DerivativesAgreeWithDifferences) {
  const JointPathCost cost{.margin = 0.1, .weight = 50.0};
  const JointVector q = InTwoWalls();
  JointVector direction;
  direction << 0.1, 0.7, -0.2, 0.4, 0.3, -0.3, 0.2;
  const double step = 1e-5;
  const JointVector after = q + step * direction;
  const JointVector before = q - step * direction;
  const JointPathCost::Derivatives along = cost.WallAlong(q, direction);
  EXPECT_NEAR(along.first, (cost.Wall(after) - cost.Wall(before)) / (2.0 * step), 1e-8);
  EXPECT_NEAR(along.second,
              (cost.WallAlong(after, direction).first - cost.WallAlong(before, direction).first) /
                  (2.0 * step),
              1e-6);
}

TEST(JointPathCost, KeepsADistanceAsItKeepsALimit) {
  // The distance to joint 1 at 0.5 rad is a limit of joint 1 there.
  const auto to_half = [](const JointVector& q) { return 0.5 - q[0]; };
  const JointPathCost kept{.margin = 0.1, .weight = 50.0, .kept_distances = {{to_half, 0.1, 50.0}}};
  JointPathCost limited{.margin = 0.1, .weight = 50.0};
  limited.range.upper[0] = 0.5;
  for (const double q1 : {0.3, 0.43, 0.6}) {
    JointVector q = InTwoWalls();
    q[0] = q1;
    const JointVector direction = JointVector::Constant(0.3);
    EXPECT_NEAR(kept.Wall(q), limited.Wall(q), 1e-12);
    EXPECT_NEAR(kept.WallAlong(q, direction).first, limited.WallAlong(q, direction).first, 1e-9);
    EXPECT_NEAR(kept.WallAlong(q, direction).second, limited.WallAlong(q, direction).second, 1e-9);
  }
}

}  // namespace
}  // namespace calibrato
