#include "calibrato/geometry/so3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "calibrato/geometry/expect_jacobian.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kPi = std::numbers::pi;

// Zero, tiny, both sides of the switch to the series, ordinary, nearly pi.
std::vector<Vector3d> RotationVectors() {
  const Vector3d axis = Vector3d(1.0, -2.0, 0.5).normalized();
  std::vector<Vector3d> vectors = {Vector3d::Zero()};
  for (const double angle : {1e-12, 1e-6, 0.99e-3, 1.01e-3, 0.1, 1.0, 2.5, kPi - 1e-6}) {
    vectors.push_back(angle * axis);
    vectors.push_back(angle * Vector3d::UnitZ());
  }
  return vectors;
}

TEST(So3, HatIsTheCrossProduct) {
  const Vector3d a(1.0, 2.0, 3.0);
  const Vector3d b(-4.0, 0.5, 2.0);
  EXPECT_LT((Hat(a) * b - a.cross(b)).norm(), 1e-15);
}

TEST(So3, QuarterTurnAboutZMapsXToY) {
  const Vector3d y = ExpSo3(kPi / 2 * Vector3d::UnitZ()) * Vector3d::UnitX();
  EXPECT_LT((y - Vector3d::UnitY()).norm(), 1e-15);
}

TEST(So3, ExpIsARotation) {
  for (const Vector3d& phi : RotationVectors()) {
    const Matrix3d R = ExpSo3(phi);
    EXPECT_LT((R * R.transpose() - Matrix3d::Identity()).norm(), 1e-14) << phi.transpose();
    EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
  }
}

TEST(So3, LogInvertsExp) {
  for (const Vector3d& phi : RotationVectors()) {
    EXPECT_LT((LogSo3(ExpSo3(phi)) - phi).norm(), 1e-9 * (1.0 + phi.norm())) << phi.transpose();
  }
}

TEST(So3, LogOfAHalfTurnHasNormPi) {
  const Vector3d axis = Vector3d(3.0, 1.0, -2.0).normalized();
  const Vector3d phi = LogSo3(ExpSo3(kPi * axis));
  EXPECT_NEAR(phi.norm(), kPi, 1e-7);
  EXPECT_NEAR(std::abs(phi.normalized().dot(axis)), 1.0, 1e-12);
}

TEST(So3, LeftJacobianIsTheDerivativeOfExp) {
  for (const Vector3d& phi : RotationVectors()) {
    const auto f = [&](const VectorXd& d) -> VectorXd {
      return LogSo3(ExpSo3(phi + Vector3d(d)) * ExpSo3(phi).transpose());
    };
    ExpectJacobian(f, VectorXd::Zero(3), LeftJacobianSo3(phi), 1e-8);
  }
}

TEST(So3, RightJacobianIsTheDerivativeOfExp) {
  for (const Vector3d& phi : RotationVectors()) {
    const auto f = [&](const VectorXd& d) -> VectorXd {
      return LogSo3(ExpSo3(phi).transpose() * ExpSo3(phi + Vector3d(d)));
    };
    ExpectJacobian(f, VectorXd::Zero(3), RightJacobianSo3(phi), 1e-8);
  }
}

TEST(So3, InverseJacobiansInvert) {
  for (const Vector3d& phi : RotationVectors()) {
    EXPECT_LT((LeftJacobianSo3(phi) * LeftJacobianInverseSo3(phi) - Matrix3d::Identity()).norm(),
              1e-9);
    EXPECT_LT((RightJacobianSo3(phi) * RightJacobianInverseSo3(phi) - Matrix3d::Identity()).norm(),
              1e-9);
  }
}

TEST(So3, NearestRotationKeepsARotationAndMendsAScaledOne) {
  const Matrix3d R = ExpSo3(Vector3d(0.3, -0.2, 1.0));
  EXPECT_LT((NearestRotation(R) - R).norm(), 1e-14);
  EXPECT_LT((NearestRotation(1.3 * R) - R).norm(), 1e-14);
}

}  // namespace
}  // namespace calibrato
