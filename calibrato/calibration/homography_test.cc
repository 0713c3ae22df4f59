#include "calibrato/calibration/homography.h"

#include <gtest/gtest.h>

#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

Eigen::Matrix2Xd Grid() {
  Eigen::Matrix2Xd points(2, 12);
  for (int k = 0; k < 12; ++k) points.col(k) << 0.1 * (k % 4), 0.1 * static_cast<int>(k / 4);
  return points;
}

TEST(Homography, RecoversTheOneThatMadeThePoints) {
  Eigen::Matrix3d H;
  H << 500.0, 30.0, 320.0, -20.0, 480.0, 200.0, 0.1, -0.3, 1.0;
  const Eigen::Matrix2Xd image = (H * Grid().colwise().homogeneous()).colwise().hnormalized();
  const auto estimate = EstimateHomography(Grid(), image);
  ASSERT_TRUE(estimate);
  EXPECT_LT((*estimate / (*estimate)(2, 2) - H).norm(), 1e-8);
}

TEST(Homography, NeedsPointsThatSpanThePlane) {
  Eigen::Matrix2Xd line(2, 6);
  for (int k = 0; k < 6; ++k) line.col(k) << k, 2.0 * k;
  EXPECT_FALSE(EstimateHomography(line, line));
  EXPECT_FALSE(EstimateHomography(Grid().leftCols(3), Grid().leftCols(3)));
}

TEST(Homography, PoseIsRecoveredInFrontOfTheCamera) {
  const Rigid3 T_c_g{ExpSo3({2.8, 0.4, -0.3}), {0.1, -0.2, 1.5}};
  Eigen::Matrix3d H;
  H << T_c_g.R.col(0), T_c_g.R.col(1), T_c_g.t;
  for (const double scale : {1.0, -0.01, 250.0}) {
    const auto pose = PoseFromHomography(scale * H);
    ASSERT_TRUE(pose);
    EXPECT_LT((pose->R - T_c_g.R).norm() + (pose->t - T_c_g.t).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace calibrato
