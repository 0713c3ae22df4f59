#include "calibrato/calibration/camera_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "calibrato/base/input_error.h"
#include "calibrato/base/input_error_testing.h"
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

TEST(CalibrateCamera, HoldsAParameterAtTheValueThatIsGiven) {
  CameraProblem problem = MakeProblem(10, 0.2, 6);
  HoldParameters({"fu=585.5", "k1=-0.21"}, &problem);
  const CameraCalibration result = CalibrateCamera(problem);
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_EQ(result.model->parameters()(0), 585.5);
  EXPECT_EQ(result.model->parameters()(4), -0.21);
  EXPECT_EQ(result.covariance(0, 0), 0.0);
  EXPECT_GT(result.covariance(1, 1), 0.0);
}

TEST(CalibrateCamera, HoldsAFocalLengthWhereTheViewsHaveIt) {
  CameraProblem problem = MakeProblem(10, 0.2, 6);
  const CameraCalibration free = CalibrateCamera(problem);
  HoldParameters({"fu"}, &problem);
  const CameraCalibration held = CalibrateCamera(problem);
  EXPECT_EQ(held.termination, Termination::kConverged);
  // The least squares are where they were, and the others' errors smaller for what is taken as
  // known.
  EXPECT_LT((held.model->parameters() - free.model->parameters()).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_EQ(held.covariance(0, 0), 0.0);
  EXPECT_LT(held.covariance(1, 1), 0.5 * free.covariance(1, 1));
}

TEST(CalibrateCamera, HoldsThePrincipalPointInTheMiddleOfTheImage) {
  CameraProblem problem = MakeProblem(10, 0.2, 7);
  HoldParameters({"pu", "pv"}, &problem);
  const CameraCalibration result = CalibrateCamera(problem);
  EXPECT_EQ(result.model->parameters()(2), 0.5 * (kImage.width - 1));
  EXPECT_EQ(result.model->parameters()(3), 0.5 * (kImage.height - 1));
}

TEST(CalibrateCamera, CountsWhyViewsDoNotFitWhereTooFewDo) {
  // Two good views, one of corners in disorder, and one of three corners.
  CameraProblem problem = MakeProblem(4, 0.2, 8);
  Rng rng(9);
  for (double& x : problem.views[1].pixels.reshaped()) x = rng.Uniform(0.0, 400.0);
  BoardView& few = problem.views[3];
  few.corner_ids.resize(3);
  few.pixels = few.pixels.leftCols<3>().eval();
  few.points_g = few.points_g.leftCols<3>().eval();
  const CameraCalibration result = CalibrateCamera(problem);
  EXPECT_EQ(result.termination, Termination::kNoStart);
  EXPECT_FALSE(result.model);
  ASSERT_EQ(result.rejected_views.size(), 2U);
  EXPECT_EQ(result.rejected_views[0].name, "1");
  EXPECT_NE(result.rejected_views[0].reason, ViewRejection::kTooFewCorners);
  EXPECT_EQ(result.rejected_views[0].num_corners, 42);
  EXPECT_EQ(result.rejected_views[1].name, "3");
  EXPECT_EQ(result.rejected_views[1].reason, ViewRejection::kTooFewCorners);
}

TEST(CalibrateCamera, CoverageIsThatOfTheViewsThatFit) {
  // All in the middle but one, which does not fit.
  CameraProblem problem = MakeProblem(30, 0.2, 10);
  std::erase_if(problem.views, [](const BoardView& view) {
    return std::abs(view.pixels.row(0).mean() - 320.0) > 80.0;
  });
  ASSERT_GE(problem.views.size(), 6U);
  const CameraCalibration middle = CalibrateCamera(problem);
  ASSERT_LT(middle.coverage.x, 0.8);
  BoardView wrong = problem.views.front();
  wrong.name = "wrong";
  Rng rng(11);
  for (Eigen::Index k = 0; k < wrong.pixels.cols(); ++k) {
    wrong.pixels.col(k) << rng.Uniform(0.0, 100.0), rng.Uniform(0.0, 100.0);
  }
  problem.views.push_back(wrong);
  const CameraCalibration result = CalibrateCamera(problem);
  ASSERT_EQ(result.rejected_views.size(), 1U);
  EXPECT_EQ(result.coverage.x, middle.coverage.x);
  EXPECT_EQ(result.coverage.size, middle.coverage.size);
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
  EXPECT_THROW(HoldParameters({"fu=long"}, &problem), InputError);
}

TEST(HoldParameters, RefusesValuesOutOfRangeAndNamesGivenTwice) {
  const auto refused = [](const std::string& model, const std::vector<std::string>& names) {
    CameraProblem problem;
    problem.model = model;
    return InputErrorOf([&] { HoldParameters(names, &problem); });
  };
  for (const std::string word : {"fu=1e300", "fv=0.5", "fu=-500", "pu=1e9", "k1=1e300"}) {
    const std::string message = refused("pinhole-radtan", {word});
    EXPECT_NE(message.find("'" + word.substr(0, 2) + "'"), std::string::npos) << message;
    EXPECT_NE(message.find("out of its range"), std::string::npos) << message;
  }
  EXPECT_NE(refused("ds-none", {"alpha=5"}).find("0 to 1"), std::string::npos);
  EXPECT_NE(refused("eucm-none", {"beta=0"}), "");
  EXPECT_NE(refused("omni-none", {"xi=-1"}), "");
  EXPECT_NE(refused("pinhole-radtan", {"fu=500", "fu"}).find("given twice"), std::string::npos);
  EXPECT_NE(refused("pinhole-radtan", {"k1", "k1"}).find("given twice"), std::string::npos);
  EXPECT_EQ(refused("ds-none", {"xi=-0.2", "alpha=0.6", "fu=300", "pv"}), "");
}

}  // namespace
}  // namespace calibrato
