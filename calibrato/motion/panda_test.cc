#include "calibrato/motion/panda.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/rpy.h"

namespace calibrato {
namespace {

JointVector RandomJoints(Rng& rng) {
  JointVector q;
  for (int i = 0; i < 7; ++i) q[i] = rng.Uniform(Limits().lower[i], Limits().upper[i]);
  return q;
}

TEST(PandaPose, AtZeroIsStretchedUpwards) {
  // By hand: 0.088 m forward; up by 0.333 + 0.316 + 0.384 - 0.107 m, the flange looks down.
  const Rigid3 T_b_e = PandaPose(JointVector::Zero(), nullptr);
  EXPECT_LT((T_b_e.t - Eigen::Vector3d(0.088, 0.0, 0.926)).norm(), 1e-12);
  EXPECT_LT((T_b_e.R - Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal().toDenseMatrix()).norm(),
            1e-12);
}

TEST(PandaPose, OfTheReadyPoseLooksDownFromAKnownPlace) {
  // Upper arm 45 degrees backwards with the elbow 0.0825 m before it, forearm level 0.0825 m above
  // the elbow, flange down 0.088 m before the wrist.
  constexpr double kRight = 0.5 * std::numbers::pi;
  JointVector ready;
  ready << 0.0, -0.5 * kRight, 0.0, -1.5 * kRight, 0.0, kRight, 0.5 * kRight;
  const Rigid3 T_b_e = PandaPose(ready, nullptr);
  const double x = (-0.316 + 0.0825) / std::numbers::sqrt2 + 0.384 + 0.088;
  const double z = 0.333 + (0.316 + 0.0825) / std::numbers::sqrt2 + 0.0825 - 0.107;
  EXPECT_LT((T_b_e.t - Eigen::Vector3d(x, 0.0, z)).norm(), 1e-12);
  EXPECT_NEAR(T_b_e.R(2, 2), -1.0, 1e-12);
}

TEST(PandaPose, JacobianAgreesWithDifferences) {
  Rng rng(1);
  for (int k = 0; k < 20; ++k) {
    const JointVector q = RandomJoints(rng);
    JointJacobian J;
    const Rigid3 T_b_e = PandaPose(q, &J);
    const double step = 1e-6;
    for (int i = 0; i < 7; ++i) {
      const Rigid3 after = PandaPose(q + step * JointVector::Unit(i), nullptr);
      const Rigid3 before = PandaPose(q - step * JointVector::Unit(i), nullptr);
      EXPECT_LT((J.col(i) - (after.DifferenceTo(T_b_e) - before.DifferenceTo(T_b_e)) / (2.0 * step))
                    .norm(),
                1e-8);
    }
  }
}

TEST(JointLimitExcess, IsThatOfTheWorstJointAndNotANumberForNone) {
  const JointVector middle = 0.5 * (Limits().lower + Limits().upper);
  EXPECT_LT(JointLimitExcess(middle), 0.0);
  for (int i = 0; i < 7; ++i) {
    JointVector q = middle;
    q[i] = Limits().upper[i] + 0.25;
    EXPECT_NEAR(JointLimitExcess(q), 0.25, 1e-12) << i;
    q[i] = Limits().lower[i] - 0.25;
    EXPECT_NEAR(JointLimitExcess(q), 0.25, 1e-12) << i;
    q[i] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isnan(JointLimitExcess(q))) << i;
  }
}

TEST(PandaInverse, ReachesThePoseWithEverySolutionAndFindsTheOneItCameFrom) {
  Rng rng(2);
  for (int k = 0; k < 1000; ++k) {
    const JointVector q = RandomJoints(rng);
    const Rigid3 T_b_e = PandaPose(q, nullptr);
    const std::vector<JointVector> solutions = PandaInverse(T_b_e, q[6]);
    double nearest = 10.0;
    for (const JointVector& solution : solutions) {
      EXPECT_LT(PandaPose(solution, nullptr).DifferenceTo(T_b_e).norm(), 1e-6);
      nearest = std::min(nearest, (solution - q).norm());
    }
    EXPECT_LT(nearest, 1e-5) << q.transpose();
    EXPECT_EQ(PandaShortfall(T_b_e, q[6]), 0.0);
  }
}

TEST(PandaShortfall, IsTheDistanceBeyondTheStretchedArm) {
  // Far along +x, the flange looking ahead: with any q7 the wrist lies 0.107 m back and 0.088 m to
  // a side; shoulder to wrist spans at most |u1| + |u2| = hypot(.316, .0825) + hypot(.384, .0825).
  const Rigid3 T_b_e{RotationFromRpy({0.0, 1.5707963267948966, 0.0}), {1.0, 0.0, 0.333}};
  const double span = std::hypot(0.316, 0.0825) + std::hypot(0.384, 0.0825);
  const double wrist = std::hypot(1.0 - 0.107, 0.088);
  EXPECT_NEAR(PandaShortfall(T_b_e, 0.3), wrist - span, 1e-12);
  EXPECT_TRUE(PandaInverse(T_b_e, 0.3).empty());
}

TEST(PandaInverseNear, ConvergesFromNearbyAndGivesUpOutOfReach) {
  Rng rng(3);
  for (int k = 0; k < 100; ++k) {
    const JointVector q = RandomJoints(rng);
    JointVector near = q;
    for (double& angle : near) angle += rng.Uniform(-0.02, 0.02);
    const Rigid3 T_b_e = PandaPose(q, nullptr);
    const std::optional<JointVector> solution = PandaInverseNear(T_b_e, near);
    if (!solution) continue;  // close to a singularity
    EXPECT_LT(PandaPose(*solution, nullptr).DifferenceTo(T_b_e).norm(), 1e-9);
  }
  JointVector ready;
  ready << 0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785;
  Rigid3 far = PandaPose(ready, nullptr);
  far.t.x() += 0.9;
  EXPECT_FALSE(PandaInverseNear(far, ready).has_value());
}

TEST(PandaNullDirection, LeavesThePoseAtRest) {
  Rng rng(4);
  for (int k = 0; k < 100; ++k) {
    JointJacobian J;
    (void)PandaPose(RandomJoints(rng), &J);
    const JointVector direction = PandaNullDirection(J);
    EXPECT_NEAR(direction.norm(), 1.0, 1e-12);
    EXPECT_LT((J * direction).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace calibrato
