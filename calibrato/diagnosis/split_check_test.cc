#include "calibrato/diagnosis/split_check.h"

#include <gtest/gtest.h>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

CameraProblem MakeProblem(int num_views, double noise, Rng rng) {
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 590.0, 322.0, 236.0, -0.2, 0.05, 0.0, 0.0;
  CameraProblem problem;
  problem.resolution = {640, 480};
  problem.views = SyntheticViews(CameraModel("pinhole-radtan", parameters), problem.resolution,
                                 Checkerboard{6, 7, 0.055, 0.055}, num_views, noise, rng);
  return problem;
}

TEST(CheckSplit, IsCalibratedOnGoodData) {
  const int num_rigs = FullSample() ? 1000 : 60;
  double sum_of_statistics = 0.0;
  double sum_of_ratios = 0.0;
  double sum_of_held_out_over_in_sample = 0.0;
  for (int i = 0; i < num_rigs; ++i) {
    const CameraProblem problem =
        MakeProblem(14, 0.2, Rng(1).Stream("rig", static_cast<uint64_t>(i)));
    const auto check = CheckSplit(CalibrateCamera(problem), {});
    ASSERT_TRUE(check);
    sum_of_statistics += check->significance.statistic;
    sum_of_ratios += std::pow(check->held_out_stddev_px / check->expected_held_out_stddev_px, 2);
    sum_of_held_out_over_in_sample +=
        std::pow(check->held_out_stddev_px / check->in_sample_stddev_px, 2);
  }
  // Chi-square with 8 degrees of freedom, but for the noise being estimated: mean 8, variance 16.
  EXPECT_NEAR(sum_of_statistics / num_rigs, 8.0, 0.1 + 4.0 * std::sqrt(16.0 / num_rigs));
  EXPECT_NEAR(sum_of_ratios / num_rigs, 1.0, 0.01);
  EXPECT_GT(sum_of_held_out_over_in_sample / num_rigs, 1.01);
}

TEST(CheckSplit, SeesAHalfWithAnotherCentre) {
  CameraProblem problem = MakeProblem(40, 0.1, Rng(2));
  for (size_t v = 0; v < problem.views.size(); ++v) {
    if ((v / 4) % 2 == 1) problem.views[v].pixels.row(0).array() += 10.0;
  }
  problem.reject_outliers = false;
  const auto check = CheckSplit(CalibrateCamera(problem), {});
  ASSERT_TRUE(check);
  EXPECT_NEAR(check->parameters[1](2) - check->parameters[0](2), 10.0, 4.0 * check->sigma(2));
  EXPECT_TRUE(check->significance.is_significant());
}

TEST(CheckSplit, HeldOutViewsAreWorseWhereTheLensChanges) {
  // A lens that bends rays otherwise in every second run: no pose takes that up.
  CameraProblem problem = MakeProblem(40, 0.05, Rng(3));
  for (size_t v = 0; v < problem.views.size(); ++v) {
    if ((v / 4) % 2 == 0) continue;
    const Eigen::Matrix2Xd centred = problem.views[v].pixels.colwise() - Eigen::Vector2d(320, 240);
    const Eigen::RowVectorXd squared_radius = (centred / 300.0).colwise().squaredNorm();
    problem.views[v].pixels += 0.02 * centred * squared_radius.asDiagonal();
  }
  problem.reject_outliers = false;
  const auto check = CheckSplit(CalibrateCamera(problem), {});
  ASSERT_TRUE(check);
  EXPECT_GT(check->held_out_stddev_px, 1.5 * check->expected_held_out_stddev_px);
}

TEST(CheckSplit, IsNothingWithTooFewViews) {
  EXPECT_FALSE(CheckSplit(CalibrateCamera(MakeProblem(5, 0.1, Rng(4))), {}));
  EXPECT_FALSE(CheckSplit({}, {}));
}

}  // namespace
}  // namespace calibrato
