#include "calibrato/calibration/prediction_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};

CameraModel Pinhole(double fu, double fv, double pu, double pv) {
  return {"pinhole-none", Eigen::Vector4d(fu, fv, pu, pv)};
}

TEST(PredictionError, OfTheTruthIsZero) {
  EXPECT_NEAR(PredictionErrorPx(Pinhole(500, 510, 320, 240), Pinhole(500, 510, 320, 240), kImage),
              0.0, 1e-12);
}

TEST(PredictionError, OfAShiftedCentreIsTheShift) {
  EXPECT_NEAR(PredictionErrorPx(Pinhole(500, 500, 323, 244), Pinhole(500, 500, 320, 240), kImage),
              5.0, 1e-12);
}

TEST(PredictionError, OfAFocalLengthGrowsWithTheRadius) {
  // 1 % of the distance from the centre; mean squares of a uniform grid of n over a width w: w^2 /
  // 12 (1 - 1/n^2).
  const double expected = 0.01 * std::sqrt(640.0 * 640.0 / 12.0 * (1.0 - 1.0 / 256.0) +
                                           480.0 * 480.0 / 12.0 * (1.0 - 1.0 / 144.0));
  EXPECT_NEAR(
      PredictionErrorPx(Pinhole(505, 505, 319.5, 239.5), Pinhole(500, 500, 319.5, 239.5), kImage),
      expected, 1e-9);
}

// An image of a few pixels in the middle of a lens: all is as on the optical axis.
constexpr Resolution kDot{2, 2};

CameraCalibrationState OnTheAxis() {
  return {Pinhole(500, 500, 0.5, 0.5), {ExpSo3({0.3, -0.2, 0.1}), Eigen::Vector3d::Zero()}, 0.0};
}

// 1 ms at 1 rad/s is a turn by 1 mrad; that about the optical axis moves nothing.
TEST(PredictionError, OfATimeOffsetIsThatOfATurn) {
  CameraCalibrationState estimate = OnTheAxis();
  estimate.time_offset_s = 1e-3;
  const double expected = 500.0 * 1e-3 * std::sqrt(2.0 / 3.0);
  EXPECT_NEAR(PredictionErrorPx(estimate, OnTheAxis(), kDot), expected, 1e-3 * expected);
}

// 1 mm to the side is 1 px at 0.5 m, 0.25 px at 2 m and nothing at infinity.
TEST(PredictionError, OfATranslationIsThatOfNearPoints) {
  CameraCalibrationState estimate = OnTheAxis();
  estimate.T_c_i.t.x() = 1e-3;
  const double expected = std::sqrt((1.0 + 0.0625 + 0.0) / 3.0);
  EXPECT_NEAR(PredictionErrorPx(estimate, OnTheAxis(), kDot), expected, 1e-3 * expected);
}

TEST(PredictionError, OfExactExtrinsicsIsThatOfTheLens) {
  CameraCalibrationState truth = OnTheAxis();
  truth.model = Pinhole(500, 500, 320, 240);
  truth.T_c_i.t = {0.1, -0.2, 0.05};
  CameraCalibrationState estimate = truth;
  estimate.model = Pinhole(503, 499, 321, 242);
  EXPECT_NEAR(PredictionErrorPx(estimate, truth, kImage),
              PredictionErrorPx(estimate.model, truth.model, kImage), 1e-9);
}

// Against errors drawn from the covariance.
TEST(PredictionError, IsOnAverageWhatTheCovarianceLetsExpect) {
  CameraCalibrationState truth{
      CameraModel("pinhole-radtan",
                  (Eigen::VectorXd(8) << 420, 418, 322, 238, -0.25, 0.06, 4e-4, -3e-4).finished()),
      {ExpSo3({0.3, -0.2, 1.1}), {0.05, -0.03, 0.02}},
      0.01,
      2e-5};
  CameraImuLayout::Camera columns;
  columns.pose = 0;
  columns.time_offset = 6;
  columns.line_delay = 7;
  columns.parameters = 8;
  Eigen::VectorXd sigma(16);
  sigma << 2e-3, 1e-3, 3e-3, 2e-3, 1e-3, 3e-3, 1e-3, 2e-6, 0.4, 0.5, 0.6, 0.3, 1e-3, 1e-3, 1e-4,
      1e-4;
  Rng rng(1);
  Eigen::MatrixXd root(16, 16);
  for (double& entry : root.reshaped()) entry = 0.3 * rng.Normal();
  root.diagonal().array() += 1.0;
  root = sigma.asDiagonal() * root;
  const double expected =
      ExpectedPredictionErrorPx(truth, kImage, columns, root * root.transpose());

  constexpr int kNumDraws = 2000;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    Eigen::VectorXd normal(16);
    for (double& entry : normal) entry = rng.Normal();
    const Eigen::VectorXd error = root * normal;
    CameraCalibrationState estimate = truth;
    estimate.T_c_i = truth.T_c_i.Perturbed(error.head<6>());
    estimate.time_offset_s += error(6);
    estimate.line_delay_s += error(7);
    estimate.model = CameraModel("pinhole-radtan", truth.model.parameters() + error.tail<8>());
    const double squared = std::pow(PredictionErrorPx(estimate, truth, kImage), 2);
    sum += squared;
    sum_of_squares += squared * squared;
  }
  const double mean = sum / kNumDraws;
  const double deviation = std::sqrt((sum_of_squares / kNumDraws - mean * mean) / kNumDraws);
  // A hundredth for what is not linear.
  EXPECT_NEAR(mean, expected * expected, 3.5 * deviation + 0.01 * mean);
  EXPECT_LT(deviation, 0.05 * mean);
}

// What was held adds nothing.
TEST(PredictionError, OfWhatWasHeldIsNotExpected) {
  CameraImuLayout::Camera columns;
  const Eigen::MatrixXd covariance = 1e-6 * Eigen::MatrixXd::Identity(6, 6);
  const double pose_alone = ExpectedPredictionErrorPx(OnTheAxis(), kDot, columns, covariance);
  // 1 mrad about x and y each; 1 mm along x and y each at 0.5 m and 2 m.
  EXPECT_NEAR(pose_alone, std::sqrt(2.0 * 0.25 + 2.0 * (1.0 + 0.0625) / 3.0), 1e-3);
}

}  // namespace
}  // namespace calibrato
