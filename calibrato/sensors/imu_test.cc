#include "calibrato/sensors/imu.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d kGravity_w(0.0, 0.0, -kStandardGravity);
const Vector3d kNoBias = Vector3d::Zero();

ImuMotion AtRest(const Matrix3d& R_w_i = Matrix3d::Identity()) {
  return {R_w_i, Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
}

ImuMotion SomeMotion() {
  return {ExpSo3({0.4, -1.1, 0.7}), {0.3, -0.8, 1.2}, {2.0, 0.5, -1.5}, {0.7, -0.2, 1.1}};
}

TEST(SpecificForce, OfALevelImuAtRestPointsUp) {
  EXPECT_EQ(SpecificForce(AtRest(), kGravity_w), Vector3d(0.0, 0.0, 9.80665));
}

TEST(SpecificForce, OfAnImuOnItsSideIsAlongTheAxisThatPointsUp) {
  // Turned by +90 degrees about x, y of the IMU points up.
  const ImuMotion motion = AtRest(ExpSo3({std::numbers::pi / 2.0, 0.0, 0.0}));
  EXPECT_LT((SpecificForce(motion, kGravity_w) - Vector3d(0.0, 9.80665, 0.0)).norm(), 1e-14);
}

TEST(SpecificForce, IsZeroInFreeFallAndGrowsWithUpwardAcceleration) {
  ImuMotion motion = AtRest(ExpSo3({0.1, 0.2, 0.3}));
  motion.accel_w = kGravity_w;
  EXPECT_EQ(SpecificForce(motion, kGravity_w), Vector3d(0.0, 0.0, 0.0));
  motion.R_w_i.setIdentity();
  motion.accel_w = {1.0, 0.0, 2.0};
  EXPECT_LT((SpecificForce(motion, kGravity_w) - Vector3d(1.0, 0.0, 11.80665)).norm(), 1e-14);
}

TEST(PredictGyro, OfAPerfectImuIsRatePlusBias) {
  EXPECT_LT(
      (PredictGyro(SomeMotion(), kGravity_w, {}, {0.01, 0.02, 0.03}) - Vector3d(0.31, -0.78, 1.23))
          .norm(),
      1e-14);
}

// On a turntable: 0.1 m from an axis that turns at 2 rad/s, the accelerometer feels 0.4 m/s^2
// towards the axis; while it speeds up with 3 rad/s^2, 0.3 m/s^2 along the way.
TEST(MotionOfFrame, OnATurntable) {
  ImuMotion axis = AtRest();
  axis.omega_i = {0.0, 0.0, 2.0};
  axis.alpha_i = {0.0, 0.0, 3.0};
  const ImuMotion rim = MotionOfFrame(axis, {Matrix3d::Identity(), {0.1, 0.0, 0.0}});
  EXPECT_LT((rim.accel_w - Vector3d(-0.4, 0.3, 0.0)).norm(), 1e-14);
  EXPECT_LT((PredictAccel(rim, kGravity_w, {}, kNoBias) - Vector3d(-0.4, 0.3, 9.80665)).norm(),
            1e-14);
  // Looking along -x of the table: its y is the table's z.
  Matrix3d R_i_j;
  R_i_j << 0.0, 0.0, -1.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  const ImuMotion turned = MotionOfFrame(axis, {R_i_j, {0.1, 0.0, 0.0}});
  EXPECT_LT((turned.omega_i - R_i_j.transpose() * axis.omega_i).norm(), 1e-14);
  EXPECT_LT((PredictAccel(turned, kGravity_w, {}, kNoBias) -
             R_i_j.transpose() * Vector3d(-0.4, 0.3, 9.80665))
                .norm(),
            1e-14);
}

TEST(MotionOfFrame, ChainsLikeItsTransforms) {
  const Rigid3 T_i_j{ExpSo3({0.2, 0.3, -0.5}), {0.1, -0.2, 0.3}};
  const Rigid3 T_j_k{ExpSo3({-0.7, 0.1, 0.2}), {-0.3, 0.1, 0.2}};
  const ImuMotion two_steps = MotionOfFrame(MotionOfFrame(SomeMotion(), T_i_j), T_j_k);
  const ImuMotion one_step = MotionOfFrame(SomeMotion(), T_i_j * T_j_k);
  EXPECT_LT((two_steps.accel_w - one_step.accel_w).norm(), 1e-14);
  EXPECT_LT((two_steps.omega_i - one_step.omega_i).norm(), 1e-14);
  EXPECT_LT((two_steps.alpha_i - one_step.alpha_i).norm(), 1e-14);
  EXPECT_LT((two_steps.R_w_i - one_step.R_w_i).norm(), 1e-14);
}

TEST(PredictAccel, ScalesAndSkewsBeforeTheBias) {
  ImuIntrinsics intrinsics;
  intrinsics.M_accel << 1.01, 0.0, 0.0, 0.02, 0.99, 0.0, 0.03, -0.01, 1.0;
  ImuMotion motion = AtRest();
  motion.accel_w = {1.0, 2.0, -kStandardGravity + 3.0};  // f = (1, 2, 3)
  const Vector3d expected(1.01 + 0.1, 0.02 + 1.98 + 0.2, 0.03 - 0.02 + 3.0 + 0.3);
  EXPECT_LT((PredictAccel(motion, kGravity_w, intrinsics, {0.1, 0.2, 0.3}) - expected).norm(),
            1e-14);
}

TEST(PredictGyro, TurnsIntoItsOwnAxesScalesAndFeelsForce) {
  ImuIntrinsics intrinsics;
  intrinsics.R_gyro_i = ExpSo3({0.0, 0.0, std::numbers::pi / 2.0});  // x of i is y of the gyro
  intrinsics.M_gyro.diagonal() << 1.0, 1.1, 1.0;
  intrinsics.g_sensitivity(0, 2) = 0.001;
  intrinsics.g_sensitivity(2, 1) = 0.002;
  ImuMotion motion = AtRest();
  motion.omega_i = {0.5, 0.0, 0.0};
  motion.accel_w = {4.0, 0.0, 0.0};  // f_i = (4, 0, 9.80665), in the gyro's axes (0, 4, 9.80665)
  const Vector3d expected(0.00980665, 0.55, 0.008);
  EXPECT_LT((PredictGyro(motion, kGravity_w, intrinsics, kNoBias) - expected).norm(), 1e-14);
}

// Each axis feels what a perfect IMU would feel at the end of its own lever arm.
TEST(PredictAccel, SensesEachAxisAtItsOwnPlace) {
  const ImuMotion motion = SomeMotion();
  ImuIntrinsics intrinsics;
  intrinsics.lever_arms_i.col(1) << 0.01, -0.02, 0.03;
  intrinsics.lever_arms_i.col(2) << -0.02, 0.01, 0.005;
  const Vector3d felt = PredictAccel(motion, kGravity_w, intrinsics, kNoBias);
  for (int k = 0; k < 3; ++k) {
    const ImuMotion there =
        MotionOfFrame(motion, {Matrix3d::Identity(), intrinsics.lever_arms_i.col(k)});
    EXPECT_NEAR(felt(k), SpecificForce(there, kGravity_w)(k), 1e-14) << k;
  }
  EXPECT_GT((felt - SpecificForce(motion, kGravity_w)).norm(), 1e-3);
}

}  // namespace
}  // namespace calibrato
