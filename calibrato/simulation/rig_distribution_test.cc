#include "calibrato/simulation/rig_distribution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/rpy.h"

namespace calibrato {
namespace {

TEST(DrawRig, FollowsTable4) {
  constexpr int kNumRigs = 4000;
  Rng rng(1);
  Eigen::Matrix<double, 7, 1> sum = Eigen::Matrix<double, 7, 1>::Zero();
  Eigen::Matrix<double, 7, 1> sum_of_squares = sum;
  for (int i = 0; i < kNumRigs; ++i) {
    const Rig rig = DrawRig(RigDistribution::kPaperUndistorted, rng);
    Eigen::Matrix<double, 7, 1> x;
    x << 2.0 * std::atan(320.0 / rig.cameras[0].model.focal_and_centre()(0)), rig.T_c0_i.t,
        RpyFromRotation(rig.T_c0_i.R);
    sum += x;
    sum_of_squares += x.cwiseAbs2();
  }
  const Eigen::Matrix<double, 7, 1> mean = sum / kNumRigs;
  const Eigen::Matrix<double, 7, 1> stddev =
      (sum_of_squares / kNumRigs - mean.cwiseAbs2()).cwiseSqrt();
  Eigen::Matrix<double, 7, 1> expected_mean;
  Eigen::Matrix<double, 7, 1> expected_stddev;
  expected_mean << 1.0, 0.06, 0.0, -0.10, 0.0, 0.0, 1.5708;
  expected_stddev << 0.05, 0.01, 0.01, 0.01, 0.1, 0.1, 0.1;
  for (int i = 0; i < 7; ++i) {
    // Four standard errors of the mean, and of the standard deviation.
    EXPECT_NEAR(mean(i), expected_mean(i), 4.0 * expected_stddev(i) / std::sqrt(kNumRigs)) << i;
    EXPECT_NEAR(stddev(i), expected_stddev(i), 4.0 * expected_stddev(i) / std::sqrt(2.0 * kNumRigs))
        << i;
  }
}

TEST(DrawRig, DistortedLensesSeeTheWholeImage) {
  Rng rng(2);
  double sum_of_squares = 0.0;
  for (int i = 0; i < 300; ++i) {
    const Rig rig = DrawRig(RigDistribution::kPaper, rng);
    EXPECT_TRUE(CoversImage(rig.cameras[0].model, rig.cameras[0].resolution));
    sum_of_squares += std::pow(rig.cameras[0].model.parameters()(4), 2);
  }
  EXPECT_NEAR(std::sqrt(sum_of_squares / 300), 0.1, 0.02);
}

TEST(DrawRig, UndistortedLensesDoNotDistort) {
  Rng rng(3);
  const Rig rig = DrawRig(RigDistribution::kPaperUndistorted, rng);
  EXPECT_EQ(rig.cameras[0].model.parameters().tail<5>().norm(), 0.0);
}

TEST(RigDistribution, NamesRoundTrip) {
  for (const auto distribution : {RigDistribution::kPaper, RigDistribution::kPaperUndistorted}) {
    EXPECT_EQ(RigDistributionFromName(RigDistributionName(distribution)), distribution);
  }
  EXPECT_THROW((void)RigDistributionFromName("papers"), InputError);
}

TEST(PriorMean, IsTheCameraOfOneRadian) {
  EXPECT_LT((PriorMeanIntrinsics() - Eigen::Vector4d(585.7561, 585.7561, 320.5, 240.5)).norm(),
            1e-4);
}

}  // namespace
}  // namespace calibrato
