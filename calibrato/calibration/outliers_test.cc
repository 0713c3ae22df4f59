#include "calibrato/calibration/outliers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};
const Board kBoard = Checkerboard{6, 7, 0.03, 0.03};
constexpr double kNoisePx = 0.2;

CameraProblem MakeProblem(uint64_t seed, int num_views = 20) {
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 590.0, 322.0, 236.0, -0.2, 0.05, 0.001, -0.002;
  Rng rng(seed);
  CameraProblem problem;
  problem.resolution = kImage;
  problem.views = SyntheticViews(CameraModel("pinhole-radtan", parameters), kImage, kBoard,
                                 num_views, kNoisePx, rng);
  return problem;
}

TEST(NoiseFromMedian, IsSigmaForGaussianErrorsOfWhichAThirdIsGarbage) {
  Rng rng(1);
  std::vector<double> errors;
  for (int i = 0; i < 20000; ++i) {
    const double u = rng.Normal(0.0, 0.3);
    const double v = rng.Normal(0.0, 0.3);
    errors.push_back(u * u + v * v);
  }
  EXPECT_NEAR(NoiseFromMedian(errors), 0.3, 0.005);
  for (int i = 0; i < 2000; ++i) errors.push_back(1e6);
  EXPECT_NEAR(NoiseFromMedian(errors), 0.3, 0.03);
  EXPECT_EQ(NoiseFromMedian({}), 0.0);
}

// 10,000 errors of which half are 1 px long and half 2: sigma is 2 / sqrt(2 ln 2) = 1.6986 px, and
// what is added last must be sqrt(2 ln(10000 / 1e-3 k)) sigma long: 5.6775 for k = 1, 5.4280 for
// k = 4; and 5 from k = 38 on, where 4.9961 would do.
TEST(OutlierThreshold, OneCornerMustBeFartherOffThanManyToBeLeftOut) {
  const auto threshold = [](size_t num_long, double sigmas) {
    std::vector<double> errors(10000, 1.0);
    std::fill(errors.begin() + 5000, errors.end(), 4.0);
    const double sigma = 2.0 / std::sqrt(2.0 * std::log(2.0));
    std::fill(errors.end() - static_cast<std::ptrdiff_t>(num_long), errors.end(),
              sigmas * sigmas * sigma * sigma);
    return OutlierThreshold(errors) / sigma;
  };
  EXPECT_NEAR(threshold(0, 0.0), 5.6775, 1e-3);
  EXPECT_NEAR(threshold(1, 5.6), 5.6775, 1e-3);
  EXPECT_NEAR(threshold(1, 5.7), 5.6775, 1e-3);
  EXPECT_NEAR(threshold(4, 5.3), 5.6775, 1e-3);
  EXPECT_NEAR(threshold(4, 5.5), 5.4280, 1e-3);
  EXPECT_NEAR(threshold(38, 5.01), 5.0, 1e-9);
  EXPECT_NEAR(threshold(500, 1e6), 5.0, 1e-9);
  EXPECT_EQ(OutlierThreshold({}), 1e-3);
  EXPECT_EQ(OutlierThreshold({0.0, 0.0, 1.0}), 1e-3);
}

TEST(Outliers, WrongCornersAreNamedAndTheResultIsThatWithoutThem) {
  CameraProblem problem = MakeProblem(2);
  CameraProblem without = problem;
  Rng rng(3);
  for (size_t v = 0; v < problem.views.size(); v += 2) {
    const int k = 3 + static_cast<int>(v);
    const double error = rng.Uniform(2.0, 30.0);
    problem.views[v].pixels.col(k) += error * Eigen::Vector2d(0.6, -0.8);
    ViewInliers kept{{}, std::vector<bool>(42, true), {}};
    kept.corners[static_cast<size_t>(k)] = false;
    without.views[v] = InliersOf(without.views[v], kept);
  }
  const CameraCalibration result = CalibrateCamera(problem);
  const CameraCalibration expected = CalibrateCamera(without);
  ASSERT_EQ(result.rejected_corners.size(), 10U);
  for (const RejectedCorner& corner : result.rejected_corners) {
    EXPECT_EQ(corner.corner_id, 3 + std::stoi(corner.view)) << corner.view;
    EXPECT_GT(corner.residual.norm(), 1.5);
  }
  EXPECT_TRUE(result.rejected_views.empty());
  EXPECT_EQ(result.num_corners, 20 * 42 - 10);
  EXPECT_LT((result.model->parameters() - expected.model->parameters()).norm(), 1e-3);
  EXPECT_GT(result.reprojection_rms_all_px, 1.2 * result.reprojection_rms_px);
}

TEST(Outliers, WrongViewsAreNamedAndTheResultIsThatWithoutThem) {
  CameraProblem problem = MakeProblem(4);
  CameraProblem without = problem;
  without.views.erase(without.views.begin() + 11);
  without.views.erase(without.views.begin() + 5);
  // Corners all over the place, as of a board found where there is none; and in the wrong order.
  Rng rng(5);
  for (int k = 0; k < 42; ++k) {
    problem.views[5].pixels.col(k) << rng.Uniform(0.0, 639.0), rng.Uniform(0.0, 479.0);
  }
  const Eigen::Matrix2Xd pixels = problem.views[11].pixels;
  for (int k = 0; k < 42; ++k) problem.views[11].pixels.col(k) = pixels.col(5 * k % 42);
  const CameraCalibration result = CalibrateCamera(problem);
  const CameraCalibration expected = CalibrateCamera(without);
  ASSERT_EQ(result.rejected_views.size(), 2U);
  EXPECT_EQ(result.rejected_views[0].name, "5");
  EXPECT_EQ(result.rejected_views[1].name, "11");
  EXPECT_EQ(result.rejected_views[0].reason, ViewRejection::kDoesNotFit);
  EXPECT_EQ(result.used_views.size(), 18U);
  EXPECT_LT((result.model->parameters() - expected.model->parameters()).norm(), 1e-3);
}

TEST(Outliers, AQuarterOfWrongViewsDoesNotMatter) {
  CameraProblem problem = MakeProblem(5, 24);
  Rng rng(6);
  for (size_t v = 1; v < 24; v += 4) {
    for (int k = 0; k < 42; ++k) {
      problem.views[v].pixels.col(k) << rng.Uniform(0.0, 639.0), rng.Uniform(0.0, 479.0);
    }
  }
  const CameraCalibration result = CalibrateCamera(problem);
  EXPECT_EQ(result.rejected_views.size(), 6U);
  EXPECT_EQ(result.used_views.size(), 18U);
  EXPECT_NEAR(result.noise_stddev_px, kNoisePx, 0.02);
}

// 50 calibrations of 840 corners: what a test of clean data must not see more often than by chance.
TEST(Outliers, CleanCornersAreKept) {
  size_t num_rejected = 0;
  for (uint64_t seed = 100; seed < 150; ++seed) {
    const CameraCalibration result = CalibrateCamera(MakeProblem(seed));
    EXPECT_TRUE(result.rejected_views.empty());
    num_rejected += result.rejected_corners.size();
  }
  // One in a thousand calibrations leaves something out; the wanted rate of 0.1 % would be 42.
  EXPECT_LE(num_rejected, 1U);
}

TEST(Outliers, AreKeptWhereTheyAreWanted) {
  CameraProblem problem = MakeProblem(7);
  problem.views[0].pixels(0, 0) += 20.0;
  problem.reject_outliers = false;
  const CameraCalibration result = CalibrateCamera(problem);
  EXPECT_TRUE(result.rejected_corners.empty());
  EXPECT_EQ(result.num_corners, 20 * 42);
}

}  // namespace
}  // namespace calibrato
