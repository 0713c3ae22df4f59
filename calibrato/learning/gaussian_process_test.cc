#include "calibrato/learning/gaussian_process.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

TEST(GaussianProcess, BelievesThePriorWhereNothingWasSeen) {
  const GaussianProcess nothing(Eigen::MatrixXd(2, 0), Eigen::VectorXd(), {});
  const Belief belief = nothing.At(Eigen::Vector2d(0.3, 0.4));
  EXPECT_EQ(belief.mean, 0.0);
  EXPECT_DOUBLE_EQ(belief.stddev, 0.3);
}

// One value y at a point: mean s^2 / (s^2 + n^2) y there, variance s^2 n^2 / (s^2 + n^2); at a
// distance d the first is smaller by exp(-d^2 / 2 l^2).
TEST(GaussianProcess, OfOneValueIsWhatOneComputesByHand) {
  const GaussianProcessOptions options{
      .length_scale = 2.0, .signal_stddev = 3.0, .noise_stddev = 1.0};
  const GaussianProcess process(Eigen::MatrixXd::Constant(1, 1, 5.0),
                                Eigen::VectorXd::Constant(1, 10.0), options);
  const Belief there = process.At(Eigen::VectorXd::Constant(1, 5.0));
  EXPECT_NEAR(there.mean, 9.0, 1e-12);
  EXPECT_NEAR(there.stddev, std::sqrt(0.9), 1e-12);
  const double kernel = std::exp(-0.5);
  const Belief beside = process.At(Eigen::VectorXd::Constant(1, 7.0));
  EXPECT_NEAR(beside.mean, 9.0 * kernel, 1e-12);
  EXPECT_NEAR(beside.stddev, std::sqrt(9.0 - 8.1 * kernel * kernel), 1e-12);
}

// Functions drawn as the process assumes lie inside its intervals as often as they should.
TEST(GaussianProcess, IsAsSureAsItMayBe) {
  const GaussianProcessOptions options{
      .length_scale = 0.5, .signal_stddev = 1.0, .noise_stddev = 0.3};
  constexpr int kNumPoints = 12;
  int num_inside = 0;
  constexpr int kNumDraws = 400;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    Rng rng = Rng(20).Stream("draw", static_cast<uint64_t>(draw));
    Eigen::MatrixXd points(2, kNumPoints + 1);
    for (double& x : points.reshaped()) x = rng.Uniform(0.0, 1.0);
    Eigen::MatrixXd covariance(kNumPoints + 1, kNumPoints + 1);
    for (int i = 0; i <= kNumPoints; ++i) {
      for (int j = 0; j <= kNumPoints; ++j) {
        covariance(i, j) = std::exp(-2.0 * (points.col(i) - points.col(j)).squaredNorm());
      }
      covariance(i, i) += 1e-10;
    }
    Eigen::VectorXd values(kNumPoints + 1);
    for (double& x : values) x = rng.Normal();
    values = covariance.llt().matrixL() * values;
    Eigen::VectorXd measured = values.head(kNumPoints);
    for (double& x : measured) x += 0.3 * rng.Normal();
    const Belief belief =
        GaussianProcess(points.leftCols(kNumPoints), measured, options).At(points.col(kNumPoints));
    if (std::abs(belief.mean - values(kNumPoints)) < 1.96 * belief.stddev) ++num_inside;
  }
  // Binomial, 95 % of 400: 380 +- 3 sigma of 4.4.
  EXPECT_NEAR(num_inside, 380, 13);
}

}  // namespace
}  // namespace calibrato
