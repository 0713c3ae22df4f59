#include "calibrato/calibration/imu_reading.h"

#include <gtest/gtest.h>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/expect_jacobian.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const Vector3d kGravity(1.0, -9.0, 3.0);

Vector3d RandomVector(Rng& rng, double size) {
  return {rng.Uniform(-size, size), rng.Uniform(-size, size), rng.Uniform(-size, size)};
}

ImuMotion RandomMotion(Rng& rng) {
  return {ExpSo3(RandomVector(rng, 2.0)), RandomVector(rng, 3.0), RandomVector(rng, 9.0),
          RandomVector(rng, 5.0)};
}

ImuIntrinsics RandomIntrinsics(Rng& rng) {
  ImuIntrinsics intrinsics;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column <= row; ++column) {
      intrinsics.M_accel(row, column) += rng.Uniform(-0.1, 0.1);
      intrinsics.M_gyro(row, column) += rng.Uniform(-0.1, 0.1);
    }
  }
  intrinsics.R_gyro_i = ExpSo3(RandomVector(rng, 0.1));
  for (double& entry : intrinsics.g_sensitivity.reshaped()) entry = rng.Uniform(-0.1, 0.1);
  intrinsics.lever_arms_i.col(1) = RandomVector(rng, 0.1);
  intrinsics.lever_arms_i.col(2) = RandomVector(rng, 0.1);
  return intrinsics;
}

ImuMotion Moved(const ImuMotion& motion, const VectorXd& delta) {
  return {ExpSo3(delta.segment<3>(0)) * motion.R_w_i, motion.omega_i + delta.segment<3>(3),
          motion.alpha_i + delta.segment<3>(6), motion.accel_w + delta.segment<3>(9)};
}

ImuIntrinsics Moved(ImuIntrinsics intrinsics, const VectorXd& delta) {
  int k = 0;
  for (Matrix3d* M : {&intrinsics.M_accel, &intrinsics.M_gyro}) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column <= row; ++column) (*M)(row, column) += delta(k++);
    }
  }
  intrinsics.R_gyro_i = ExpSo3(delta.segment<3>(12)) * intrinsics.R_gyro_i;
  for (int i = 0; i < 9; ++i) intrinsics.g_sensitivity(i / 3, i % 3) += delta(15 + i);
  intrinsics.lever_arms_i.col(1) += delta.segment<3>(24);
  intrinsics.lever_arms_i.col(2) += delta.segment<3>(27);
  return intrinsics;
}

template <typename Linearised, typename Predicted>
void ExpectJacobians(const Linearised& linearised, const Predicted& predicted, uint64_t seed) {
  Rng rng(seed);
  const ImuMotion motion = RandomMotion(rng);
  const ImuIntrinsics intrinsics = RandomIntrinsics(rng);
  ImuReading reading;
  linearised(motion, kGravity, intrinsics, true, &reading);
  EXPECT_LT((reading.value - predicted(motion, kGravity, intrinsics, Vector3d::Zero())).norm(),
            1e-12);
  MatrixXd J(3, 12 + 3 + 30);
  J << reading.J_motion, reading.J_gravity, reading.J_intrinsics;
  const auto f = [&](const VectorXd& delta) -> VectorXd {
    return predicted(Moved(motion, delta.head(12)), kGravity + delta.segment<3>(12),
                     Moved(intrinsics, delta.tail(30)), Vector3d::Zero());
  };
  ExpectJacobian(f, VectorXd::Zero(45), J, 1e-8);
}

TEST(ImuReading, GyroAgreesWithItsPredictionAndDifferences) {
  for (uint64_t seed = 1; seed < 4; ++seed) ExpectJacobians(LineariseGyro, PredictGyro, seed);
}

TEST(ImuReading, AccelAgreesWithItsPredictionAndDifferences) {
  for (uint64_t seed = 1; seed < 4; ++seed) ExpectJacobians(LineariseAccel, PredictAccel, seed);
}

TEST(ImuReading, MotionOfAnotherFrameAgreesWithDifferences) {
  Rng rng(7);
  const ImuMotion motion = RandomMotion(rng);
  const Rigid3 T_i_j{ExpSo3(RandomVector(rng, 1.0)), RandomVector(rng, 0.5)};
  const ImuMotion motion_j = MotionOfFrame(motion, T_i_j);
  const FrameMotionJacobians jacobians = JacobiansMotionOfFrame(motion, T_i_j);
  MatrixXd J(12, 18);
  J << jacobians.J_motion, jacobians.J_pose;
  const auto f = [&](const VectorXd& delta) -> VectorXd {
    const ImuMotion moved =
        MotionOfFrame(Moved(motion, delta.head(12)), T_i_j.Perturbed(delta.tail<6>()));
    VectorXd value(12);
    value << LogSo3(moved.R_w_i * motion_j.R_w_i.transpose()), moved.omega_i, moved.alpha_i,
        moved.accel_w;
    return value;
  };
  ExpectJacobian(f, VectorXd::Zero(18), J, 1e-8);
}

}  // namespace
}  // namespace calibrato
