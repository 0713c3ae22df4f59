#include "calibrato/calibration/plane_pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

Eigen::Matrix2Xd Grid() {
  Eigen::Matrix2Xd points(2, 12);
  for (int k = 0; k < 12; ++k) points.col(k) << 0.1 * (k % 4), 0.1 * static_cast<int>(k / 4);
  return points;
}

Eigen::Matrix3Xd Rays(const Rigid3& T_c_g, const Eigen::Matrix2Xd& plane) {
  Eigen::Matrix3Xd rays(3, plane.cols());
  for (Eigen::Index k = 0; k < plane.cols(); ++k) {
    // Of any length: 1 to 12 times the point's distance.
    rays.col(k) =
        static_cast<double>(k + 1) * (T_c_g * Eigen::Vector3d(plane(0, k), plane(1, k), 0.0));
  }
  return rays;
}

TEST(PoseFromRays, IsThePoseThatMadeThem) {
  // In front of the camera, beside it (rays on both sides of z = 0), and behind it.
  for (const Eigen::Vector3d& t : {Eigen::Vector3d(0.1, -0.2, 1.5), Eigen::Vector3d(1.0, 0.3, -0.1),
                                   Eigen::Vector3d(0.2, 0.1, -1.2)}) {
    const Rigid3 T_c_g{ExpSo3({2.8, 0.4, -0.3}), t};
    const auto pose = PoseFromRays(Grid(), Rays(T_c_g, Grid()));
    ASSERT_TRUE(pose);
    EXPECT_LT((pose->R - T_c_g.R).norm() + (pose->t - T_c_g.t).norm(), 1e-7) << t.transpose();
  }
}

TEST(PoseFromRays, NeedsPointsThatSpanThePlane) {
  Eigen::Matrix2Xd line(2, 6);
  for (int k = 0; k < 6; ++k) line.col(k) << k, 2.0 * k;
  const Rigid3 T_c_g{ExpSo3({2.8, 0.4, -0.3}), {0.1, -0.2, 15.0}};
  EXPECT_FALSE(PoseFromRays(line, Rays(T_c_g, line)));
  EXPECT_FALSE(PoseFromRays(Grid().leftCols(3), Rays(T_c_g, Grid()).leftCols(3)));
}

TEST(PoseFromRays, IsNothingForRaysInAPlane) {
  Eigen::Matrix3Xd rays = Rays({ExpSo3({2.8, 0.4, -0.3}), {0.1, -0.2, 1.5}}, Grid());
  rays.row(1).setZero();
  EXPECT_FALSE(PoseFromRays(Grid(), rays));
}

TEST(MirroredPose, KeepsTheMiddleAndMirrorsTheNormalAboutTheLineOfSight) {
  const Rigid3 T_c_g{ExpSo3({2.8, 0.4, -0.3}), {0.1, -0.2, 1.5}};
  const Eigen::Vector3d middle_g(0.15, 0.1, 0.0);
  const Rigid3 mirrored = MirroredPose(T_c_g, middle_g);
  const Eigen::Vector3d middle_c = T_c_g * middle_g;
  EXPECT_LT((mirrored * middle_g - middle_c).norm(), 1e-12);
  const Eigen::Vector3d a = T_c_g.R.col(2);
  const Eigen::Vector3d b = mirrored.R.col(2);
  EXPECT_NEAR(a.dot(middle_c), b.dot(middle_c), 1e-12);
  EXPECT_LT((a + b).cross(middle_c).norm(), 1e-12);
  EXPECT_GT((a - b).norm(), 0.1);
  const Rigid3 twice = MirroredPose(mirrored, middle_g);
  EXPECT_LT((twice.R - T_c_g.R).norm() + (twice.t - T_c_g.t).norm(), 1e-9);
}

}  // namespace
}  // namespace calibrato
