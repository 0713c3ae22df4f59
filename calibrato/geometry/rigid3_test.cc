#include "calibrato/geometry/rigid3.h"

#include <gtest/gtest.h>

#include <numbers>

#include "calibrato/geometry/expect_jacobian.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vector6d = Eigen::Matrix<double, 6, 1>;

const Rigid3 kTab{ExpSo3({0.3, -1.2, 0.4}), {0.5, -0.1, 2.0}};
const Rigid3 kTbc{ExpSo3({-0.7, 0.2, 1.4}), {-0.3, 0.8, 0.1}};

void ExpectSame(const Rigid3& actual, const Rigid3& expected) {
  EXPECT_LT((actual.R - expected.R).norm(), 1e-13);
  EXPECT_LT((actual.t - expected.t).norm(), 1e-13);
}

TEST(Rigid3, MapsAPointByHand) {
  // A quarter turn about z takes (1, 0, 0) to (0, 1, 0); the shift adds (10, 20, 30).
  const Rigid3 T_a_b{ExpSo3(std::numbers::pi / 2 * Vector3d::UnitZ()), {10.0, 20.0, 30.0}};
  EXPECT_LT((T_a_b * Vector3d(1.0, 0.0, 0.0) - Vector3d(10.0, 21.0, 30.0)).norm(), 1e-14);
}

TEST(Rigid3, ThereAndBackIsTheIdentity) {
  ExpectSame(kTab * kTab.Inverse(), Rigid3{});
  ExpectSame(kTab.Inverse() * kTab, Rigid3{});
}

TEST(Rigid3, CompositionMapsAsOneAfterTheOther) {
  const Vector3d p_c(0.2, -3.0, 1.0);
  EXPECT_LT(((kTab * kTbc) * p_c - kTab * (kTbc * p_c)).norm(), 1e-14);
}

TEST(Rigid3, MatrixActsOnHomogeneousPoints) {
  const Vector3d p(0.2, -3.0, 1.0);
  EXPECT_LT(((kTab.Matrix() * p.homogeneous()).head<3>() - kTab * p).norm(), 1e-14);
}

TEST(Rigid3, DifferenceUndoesPerturbation) {
  Vector6d delta;
  delta << 0.1, -0.2, 0.3, 1.0, -2.0, 3.0;
  EXPECT_LT((kTab.Perturbed(delta).DifferenceTo(kTab) - delta).norm(), 1e-13);
}

TEST(Rigid3, JacobianOfATransformedPoint) {
  const Vector3d p(0.2, -3.0, 1.0);
  ExpectJacobian([&](const VectorXd& d) -> VectorXd { return kTab.Perturbed(Vector6d(d)) * p; },
                 VectorXd::Zero(6), JacobianTransformedPointPose(kTab, p));
}

TEST(Rigid3, JacobiansOfAProduct) {
  const Rigid3 product = kTab * kTbc;
  ExpectJacobian(
      [&](const VectorXd& d) -> VectorXd {
        return (kTab * kTbc.Perturbed(Vector6d(d))).DifferenceTo(product);
      },
      VectorXd::Zero(6), JacobianProductSecond(kTab));
  ExpectJacobian(
      [&](const VectorXd& d) -> VectorXd {
        return (kTab.Perturbed(Vector6d(d)) * kTbc).DifferenceTo(product);
      },
      VectorXd::Zero(6), JacobianProductFirst(kTab, kTbc));
}

TEST(Rigid3, JacobianOfTheInverse) {
  ExpectJacobian(
      [&](const VectorXd& d) -> VectorXd {
        return kTab.Perturbed(Vector6d(d)).Inverse().DifferenceTo(kTab.Inverse());
      },
      VectorXd::Zero(6), JacobianInverse(kTab));
}

}  // namespace
}  // namespace calibrato
