#include "calibrato/calibration/information.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

TEST(Information, CriteriaByHand) {
  // Eigenvalues of [2 1; 1 2] are 1 and 3.
  Eigen::Matrix2d covariance;
  covariance << 2.0, 1.0, 1.0, 2.0;
  const Information information = InformationOf(covariance, Eigen::Vector2d::Ones());
  EXPECT_NEAR(information.a_optimality, 4.0, 1e-14);
  EXPECT_NEAR(information.d_optimality, 3.0, 1e-14);
  EXPECT_NEAR(information.e_optimality, 3.0, 1e-14);
  EXPECT_NEAR(information.eigenvalues(0), 1.0, 1e-14);
}

TEST(Information, IsNormalisedByItsUnits) {
  const Eigen::Vector2d sigma(2.0, 3e-3);
  const Information information =
      InformationOf(sigma.cwiseAbs2().asDiagonal(), Eigen::Vector2d(1.0, 1e-3));
  EXPECT_NEAR(information.a_optimality, 4.0 + 9.0, 1e-12);
}

TEST(CovarianceFromInformation, InvertsWhateverTheUnits) {
  Eigen::Matrix3d J;
  J << 1.0, 1e6, 2e-6, 0.5, -3e6, 1e-6, 2.0, 1e6, -4e-6;
  const Eigen::Matrix3d H = J.transpose() * J;
  const auto covariance = CovarianceFromInformation(H, {});
  ASSERT_TRUE(covariance);
  const Eigen::Matrix3d product = H * *covariance;
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(product(i, i), 1.0, 1e-9);
}

TEST(CovarianceFromInformation, LeavesHeldParametersOut) {
  Eigen::Matrix3d H = Eigen::Vector3d(4.0, 0.0, 0.25).asDiagonal();
  const auto covariance = CovarianceFromInformation(H, {false, true, false});
  ASSERT_TRUE(covariance);
  EXPECT_LT((*covariance - Eigen::Matrix3d(Eigen::Vector3d(0.25, 0.0, 4.0).asDiagonal())).norm(),
            1e-14);
}

TEST(CovarianceFromInformation, IsNothingWhereADirectionIsUnknown) {
  const Eigen::Vector3d known(1.0, 2.0, -1.0);
  const Eigen::Matrix3d H =
      Eigen::Matrix3d::Identity() - known * known.transpose() / known.squaredNorm();
  EXPECT_FALSE(CovarianceFromInformation(H, {}));
}

}  // namespace
}  // namespace calibrato
