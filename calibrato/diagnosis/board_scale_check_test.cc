#include "calibrato/diagnosis/board_scale_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "calibrato/calibration/synthetic_camera_imu_for_test.h"

namespace calibrato {
namespace {

using testing::HasSubstr;

// The check of a recording whose board is `scale` times as large as its target says.
std::optional<BoardScaleCheck> CheckOf(const SyntheticCameraImu& truth, double scale,
                                       CameraImuCalibration* calibration = nullptr) {
  Rng rng(1);
  CameraImuProblem problem = truth.Problem(rng);
  for (BoardView& view : problem.cameras[0].views) view.points_g /= scale;
  const CameraImuCalibration solved = CalibrateCameraImu(problem);
  EXPECT_TRUE(solved.state.has_value());
  if (calibration != nullptr) *calibration = solved;
  return CheckBoardScale(problem, solved);
}

TEST(CheckBoardScale, HasNothingToSayOfABoardAsStated) {
  EXPECT_FALSE(CheckOf(SyntheticCameraImu(), 1.0).has_value());
  // Nor of what is finer than boards are measured.
  EXPECT_FALSE(CheckOf(SyntheticCameraImu(), 1.003).has_value());
}

TEST(CheckBoardScale, FindsTheSizeAndTheCalibrationWithIt) {
  const SyntheticCameraImu truth;
  // Inches for centimetres, inner for outer squares, printed at 97 %, millimetres off.
  for (const double scale : {0.3937, 0.97, 0.98, 1.025, 2.54}) {
    CameraImuCalibration as_stated;
    const auto check = CheckOf(truth, scale, &as_stated);
    ASSERT_TRUE(check.has_value()) << scale;
    EXPECT_NEAR(check->scale, scale, 4.0 * check->sigma);
    EXPECT_LT(check->sigma, 0.002 * scale);
    const auto error_of = [&](const CameraImuCalibration& calibration) {
      return (calibration.state->cameras[0].T_c_i.t - truth.T_c_i[0].t).norm();
    };
    EXPECT_LT(error_of(check->calibration), 2e-3) << scale;
    EXPECT_LT(error_of(check->calibration), 0.5 * error_of(as_stated)) << scale;
  }
}

TEST(CheckBoardScale, HasNothingToSayWhereTheMotionDoesNotTell) {
  SyntheticCameraImu truth;
  truth.translation = 0.0;
  truth.rotation = 0.05;
  truth.duration_s = 3.0;
  EXPECT_FALSE(CheckOf(truth, 1.02).has_value());
}

TEST(BoardScaleFinding, SaysByHowMuchAndWhatToDo) {
  BoardScaleCheck check;
  check.scale = 1.0242;
  check.sigma = 0.0008;
  const Finding large = BoardScaleFinding(check);
  EXPECT_EQ(large.severity, Severity::kFail);
  EXPECT_THAT(large.what, HasSubstr("the board is 2.42 % larger than its target says (+- 0.08)"));
  EXPECT_THAT(large.remedy, HasSubstr("multiplied by 1.0242"));
  check.scale = 0.993;
  EXPECT_EQ(BoardScaleFinding(check).severity, Severity::kWarn);
  EXPECT_THAT(BoardScaleFinding(check).what, HasSubstr("0.70 % smaller"));
}

}  // namespace
}  // namespace calibrato
