#include "calibrato/geometry/rpy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "calibrato/geometry/expect_jacobian.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

const std::vector<Vector3d> kAngles = {
    {0.0, 0.0, 0.0}, {1.5708, 0.8, 1.5708}, {-2.0, 1.2, 3.0}, {0.4, -0.9, -1.1}};

TEST(Rpy, RollComesFirstThenPitchThenYaw) {
  // A quarter roll takes y to z; the quarter yaw after it leaves z alone.
  const double quarter = std::numbers::pi / 2;
  const Vector3d image = RotationFromRpy({quarter, 0.0, quarter}) * Vector3d::UnitY();
  EXPECT_LT((image - Vector3d::UnitZ()).norm(), 1e-15);
}

TEST(Rpy, RoundTrip) {
  for (const Vector3d& rpy : kAngles) {
    EXPECT_LT((RpyFromRotation(RotationFromRpy(rpy)) - rpy).norm(), 1e-12);
  }
}

TEST(Rpy, GimbalLockGivesTheSameRotation) {
  const Matrix3d R = RotationFromRpy({0.3, std::numbers::pi / 2, 0.5});
  EXPECT_LT((RotationFromRpy(RpyFromRotation(R)) - R).norm(), 1e-9);
}

TEST(Rpy, RatesGiveTheLeftPerturbation) {
  for (const Vector3d& rpy : kAngles) {
    const Matrix3d R = RotationFromRpy(rpy);
    ExpectJacobian(
        [&](const VectorXd& x) -> VectorXd {
          return LogSo3(RotationFromRpy(Vector3d(x)) * R.transpose());
        },
        rpy, AngularVelocityFromRpyRates(rpy));
  }
}

TEST(Rpy, AngularAccelerationIsTheDerivativeOfAngularVelocity) {
  const Vector3d rpy0(0.4, -0.9, -1.1);
  const Vector3d rates(0.5, 1.5, -0.7);
  const Vector3d accelerations(-2.0, 0.3, 1.0);
  const auto omega_at = [&](const VectorXd& t) -> VectorXd {
    const Vector3d rpy = rpy0 + rates * t(0) + 0.5 * accelerations * t(0) * t(0);
    return AngularVelocityFromRpyRates(rpy) * (rates + accelerations * t(0));
  };
  ExpectJacobian(omega_at, VectorXd::Zero(1),
                 AngularAccelerationFromRpy(rpy0, rates, accelerations));
}

}  // namespace
}  // namespace calibrato
