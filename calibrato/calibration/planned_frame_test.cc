#include "calibrato/calibration/planned_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "calibrato/calibration/bundle_adjustment.h"
#include "calibrato/geometry/expect_jacobian.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

const Board kBoard = Checkerboard{6, 7, 0.06, 0.06};

CameraModel Model() {
  return {
      "pinhole-radtan5",
      (Eigen::VectorXd(9) << 585.0, 584.0, 320.5, 240.5, -0.1, 0.05, 1e-3, -5e-4, 0.01).finished()};
}

// The board faces the camera, a little turned.
Rigid3 Pose(double distance_m = 1.2) {
  const Eigen::Matrix3d R = ExpSo3({0.1, -0.2, 0.05}) * ExpSo3({std::numbers::pi, 0.0, 0.0});
  return {R, Eigen::Vector3d(0.03, -0.02, distance_m) - R * BoardCentre(kBoard)};
}

TEST(PlannedFrame, SaysOfTheCameraWhatAMeasuredFrameSays) {
  const BoardView points = PlannedView(kBoard);
  const auto planned = CameraInformationOfFrame(Model(), points, Pose());
  ASSERT_TRUE(planned.has_value());
  const Eigen::MatrixXd measured = CameraInformation(Model(), {Pose()}, {points}, {});
  EXPECT_LT((*planned - measured).norm(), 1e-9 * measured.norm());
}

TEST(PlannedFrame, SaysOfItsPoseWhatItsPixelsSay) {
  const BoardView points = PlannedView(kBoard);
  const auto pixels = [&](const Eigen::VectorXd& delta) {
    Eigen::VectorXd all(2 * points.num_corners());
    for (Eigen::Index k = 0; k < points.num_corners(); ++k) {
      all.segment<2>(2 * k) =
          Model().Project(Pose().Perturbed(Vector6d(delta)) * points.points_g.col(k)).value();
    }
    return all;
  };
  Eigen::MatrixXd P(2 * points.num_corners(), 6);
  for (int k = 0; k < 6; ++k) {
    const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd::Unit(6, k);
    P.col(k) = (pixels(step) - pixels(-step)) / 2e-6;
  }
  const auto information = PoseInformationOfFrame(Model(), points, Pose());
  ASSERT_TRUE(information.has_value());
  EXPECT_LT((*information - P.transpose() * P).norm(), 1e-6 * information->norm());
}

TEST(PlannedFrame, IsNothingBehindTheCamera) {
  const BoardView points = PlannedView(kBoard);
  EXPECT_FALSE(CameraInformationOfFrame(Model(), points, Pose(-1.0)).has_value());
  EXPECT_FALSE(PoseInformationOfFrame(Model(), points, Pose(-1.0)).has_value());
  EXPECT_EQ(MarginInImage(Model(), {640, 480}, points, Pose(-1.0)),
            -std::numeric_limits<double>::infinity());
}

TEST(PlannedFrame, KnowsItsMarginInTheImage) {
  // Without distortion and straight ahead: corners at 1 m lie +-0.15 and +-0.18 m from the middle.
  const CameraModel model("pinhole-none", Eigen::Vector4d(500.0, 500.0, 320.5, 240.5));
  const BoardView points = PlannedView(kBoard);
  const Eigen::Matrix3d R = ExpSo3({std::numbers::pi, 0.0, 0.0});
  const auto pose = [&](double x) {
    return Rigid3{R, Eigen::Vector3d(x, 0.0, 1.0) - R * BoardCentre(kBoard)};
  };
  EXPECT_NEAR(MarginInImage(model, {640, 480}, points, pose(0.0)), 479.0 - 240.5 - 90.0, 1e-9);
  EXPECT_NEAR(MarginInImage(model, {640, 480}, points, pose(0.6)), 639.0 - 320.5 - 300.0 - 75.0,
              1e-9);
  EXPECT_NEAR(MarginInImage(model, {640, 480}, points, pose(-0.6)), 320.5 - 300.0 - 75.0, 1e-9);
}

TEST(GradientByPose, IsTheDerivativeByThePerturbation) {
  const Eigen::Matrix3d weight = Eigen::Matrix3d::Random();
  const NumberOfPose number = [&](const Rigid3& T) -> std::optional<double> {
    return weight.cwiseProduct(T.R).sum() + T.t.squaredNorm();
  };
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);
  ExpectJacobian(
      [&](const Eigen::VectorXd& delta) {
        return Eigen::VectorXd::Constant(1, number(Pose().Perturbed(Vector6d(delta))).value());
      },
      zero, GradientByPose(number, Pose()).transpose(), 1e-8);
}

}  // namespace
}  // namespace calibrato
