#include "calibrato/motion/singularity.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>

namespace calibrato {
namespace {

JointVector Usual() {
  JointVector q;
  q << 0.2, -0.5, 0.1, -2.0, 0.3, 1.8, 0.7;
  return q;
}

TEST(SingularityDistance, IsLargeInAUsualPosture) { EXPECT_GT(SingularityDistance(Usual()), 0.1); }

TEST(SingularityDistance, IsSmallWhereTheElbowIsStretched) {
  // Not quite zero: the last joint's axis passes the wrist by 88 mm, and can still lengthen the
  // arm.
  JointVector q = Usual();
  q[3] = StretchedElbow();
  EXPECT_LT(SingularityDistance(q), 0.1 * kMinSingularityDistance);
  EXPECT_EQ(SingularPart(q), "elbow");
  // The wrist is as far from the shoulder as it gets.
  const double farthest = (AxesOf(q).T_b_link[4].t - AxesOf(q).T_b_link[1].t).norm();
  for (const double step : {-0.2, 0.2}) {
    JointVector bent = q;
    bent[3] += step;
    EXPECT_LT((AxesOf(bent).T_b_link[4].t - AxesOf(bent).T_b_link[1].t).norm(), farthest);
    EXPECT_GT(SingularityDistance(bent), kMinSingularityDistance);
  }
}

TEST(SingularityDistance, IsSmallWhereWristAndShoulderAreInLineAtOnce) {
  // Axes 5 and 7 in line leave a way out by the redundancy ...
  JointVector q = Usual();
  q[5] = 0.0;
  EXPECT_EQ(SingularPart(q), "wrist");
  EXPECT_GT(SingularityDistance(q), 0.1);
  // ... but not with axes 1 and 3 in line as well, and the elbow to the side.
  q << 0.099, 0.0, 1.423, -1.356, 2.493, 0.0, 2.2;
  EXPECT_LT(SingularityDistance(q), 1e-3);
}

TEST(SingularityDistance, IsTheLeastSingularValueOfAnSvd) {
  const JointVector q = Usual();
  JointJacobian J;
  (void)PandaPose(q, &J);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Eigen::MatrixXd(J), Eigen::ComputeThinU);
  EXPECT_NEAR(SingularityDistance(q), svd.singularValues()[5], 1e-9);
}

}  // namespace
}  // namespace calibrato
