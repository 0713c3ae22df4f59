#include "calibrato/calibration/camera_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};
const Board kBoard = Checkerboard{6, 7, 0.03, 0.03};

CameraModel Lens() {
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 590.0, 322.0, 236.0, -0.2, 0.05, 0.001, -0.002;
  return {"pinhole-radtan", parameters};
}

CameraProblem MakeProblem(int num_views, double noise, uint64_t seed) {
  Rng rng(seed);
  CameraProblem problem;
  problem.resolution = kImage;
  problem.views = SyntheticViews(Lens(), kImage, kBoard, num_views, noise, rng);
  return problem;
}

TEST(CalibrateCamera, FindsTheLensWithinItsStatedSigma) {
  const CameraCalibration result = CalibrateCamera(MakeProblem(20, 0.2, 1));
  EXPECT_EQ(result.termination, Termination::kConverged);
  const Eigen::VectorXd difference = result.model->parameters() - Lens().parameters();
  const double squared_distance = difference.dot(result.covariance.ldlt().solve(difference));
  EXPECT_LT(squared_distance, 26.1);  // The 99.9 % point of chi-square with 8 degrees of freedom.
  EXPECT_NEAR(result.noise_stddev_px, 0.2, 0.02);
  EXPECT_EQ(result.num_corners, 20 * 42);
}

TEST(CalibrateCamera, RmsIsOverCornersAndSigmaOverDegreesOfFreedom) {
  const CameraCalibration result = CalibrateCamera(MakeProblem(5, 0.2, 2));
  double sum = 0.0;
  for (const auto& residuals : result.residuals) sum += residuals.squaredNorm();
  EXPECT_NEAR(result.reprojection_rms_px, std::sqrt(sum / 210.0), 1e-9);
  EXPECT_NEAR(result.noise_stddev_px, std::sqrt(sum / (420.0 - 8.0 - 30.0)), 1e-9);
}

TEST(CalibrateCamera, HeldParametersHaveNoVariance) {
  CameraProblem problem = MakeProblem(10, 0.2, 3);
  HoldParameters({"p1", "k2"}, &problem);
  const CameraCalibration result = CalibrateCamera(problem);
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_EQ(result.model->parameters()(5), 0.0);
  EXPECT_EQ(result.model->parameters()(6), 0.0);
  EXPECT_EQ(result.covariance(6, 6), 0.0);
  EXPECT_GT(result.covariance(7, 7), 0.0);
}

TEST(CalibrateCamera, TwoViewsAreTooFew) {
  const CameraCalibration result = CalibrateCamera(MakeProblem(2, 0.2, 4));
  EXPECT_EQ(result.termination, Termination::kNoStart);
  EXPECT_FALSE(result.model);
  EXPECT_EQ(result.covariance.size(), 0);
}

TEST(CalibrateCamera, FrontalViewsLeaveTheFocalLengthUnknown) {
  // Three views of a board parallel to the image: distance and focal length can't be told apart.
  CameraProblem problem;
  problem.resolution = kImage;
  problem.model = "pinhole-none";
  for (const double depth : {0.8, 1.0, 1.3}) {
    BoardView view;
    view.points_g = BoardPoints(kBoard);
    view.pixels = 585.0 / depth * view.points_g.topRows<2>();
    view.pixels.row(0).array() += 200.0;
    view.pixels.row(1).array() += 150.0;
    problem.views.push_back(view);
  }
  const CameraCalibration result = CalibrateCamera(problem);
  EXPECT_EQ(result.termination, Termination::kRankDeficient);
  EXPECT_EQ(result.covariance.size(), 0);
}

TEST(CalibrateCamera, RefusesABoardThatIsNotFlat) {
  CameraProblem problem = MakeProblem(5, 0.2, 5);
  problem.views[3].points_g(2, 7) = 0.01;
  EXPECT_THROW((void)CalibrateCamera(problem), InputError);
}

TEST(HoldParameters, ListsTheNamesWhenOneIsWrong) {
  CameraProblem problem;
  try {
    HoldParameters({"k3"}, &problem);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("p2"), std::string::npos) << error.what();
  }
  EXPECT_THROW(HoldParameters({"fu", "fv", "pu", "pv", "k1", "k2", "p1", "p2"}, &problem),
               InputError);
}

}  // namespace
}  // namespace calibrato
