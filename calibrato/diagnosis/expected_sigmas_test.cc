#include "calibrato/diagnosis/expected_sigmas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/diagnosis/camera_imu_parts.h"

namespace calibrato {
namespace {

using testing::HasSubstr;

// Before the solve as after it: the sigmas that the calibration itself states, to a fifth.
TEST(ExpectedExtrinsics, AreTheSigmasOfTheCalibration) {
  const SyntheticCameraImu rig;
  Rng rng(4);
  const CameraImuProblem problem = rig.Problem(rng);
  const std::vector<ExpectedSigma> expected = ExpectedExtrinsics(problem);
  ASSERT_EQ(expected.size(), 7U);
  const CameraImuCalibration calibration = CalibrateCameraImu(problem);
  ASSERT_EQ(calibration.termination, Termination::kConverged);
  const std::vector<double> sigmas = SigmasOf(calibration.information);
  for (const ExpectedSigma& parameter : expected) {
    bool is_there = false;
    for (size_t k = 0; k < sigmas.size(); ++k) {
      if (calibration.information.names[k] != parameter.name) continue;
      is_there = true;
      EXPECT_NEAR(parameter.sigma / sigmas[k], 1.0, 0.2) << parameter.name;
    }
    EXPECT_TRUE(is_there) << parameter.name;
    EXPECT_EQ(parameter.verdict, Verdict::kPass);
    EXPECT_EQ(parameter.advice, "");
  }
  EXPECT_TRUE(FindingsOnExpectedSigmas(expected).empty());
}

// Slower motion is felt less: what is missing is said in seconds, or in a motion.
TEST(ExpectedExtrinsics, SayWhatToRecord) {
  SyntheticCameraImu rig;
  rig.duration_s = 5.0;
  rig.slowest_rad_s = 0.8;
  rig.rotation = 0.5;
  rig.imu_noise = {200.0, 2e-3, 3e-4, 2e-4, 2e-5};
  Rng rng(4);
  const std::vector<ExpectedSigma> expected = ExpectedExtrinsics(rig.Problem(rng));
  const std::vector<Finding> findings = FindingsOnExpectedSigmas(expected);
  ASSERT_FALSE(findings.empty());
  EXPECT_THAT(findings[0].what, HasSubstr("the translation: expected sigma of cam0.pos_"));
  EXPECT_THAT(findings[0].remedy, testing::AnyOf(HasSubstr(" s more, rotate about "),
                                                 HasSubstr("turn the camera to and fro")));
}

TEST(ExpectedExtrinsics, OfARigThatDoesNotTurnThereAreNone) {
  SyntheticCameraImu rig;
  rig.rotation = 0.0;
  rig.noise_scale = 0.0;
  Rng rng(4);
  for (const ExpectedSigma& parameter : ExpectedExtrinsics(rig.Problem(rng))) {
    EXPECT_NE(parameter.verdict, Verdict::kPass) << parameter.name;
  }
}

TEST(ExpectedIntrinsics, AreThoseOfTheCovariance) {
  CameraProblem problem;
  problem.model = "pinhole-none";
  CameraCalibration calibration;
  calibration.model.emplace("pinhole-none", Eigen::Vector4d(500.0, 400.0, 320.0, 240.0));
  calibration.covariance = Eigen::Vector4d(4.0, 25.0, 1.0, 1.0).asDiagonal();
  const std::vector<ExpectedSigma> expected = ExpectedIntrinsics("cam1", problem, calibration);
  ASSERT_EQ(expected.size(), 4U);
  EXPECT_EQ(expected[0].name, "cam1.fu");
  EXPECT_DOUBLE_EQ(expected[0].sigma, 2.0);
  EXPECT_DOUBLE_EQ(expected[0].enough, 5.0);
  EXPECT_EQ(expected[0].verdict, Verdict::kPass);
  EXPECT_DOUBLE_EQ(expected[1].enough, 4.0);  // 1 % of its own focal length
  EXPECT_EQ(expected[1].verdict, Verdict::kInconclusive);
  const std::vector<Finding> findings = FindingsOnExpectedSigmas(expected);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Severity::kInconclusive);
  EXPECT_THAT(findings[0].what,
              HasSubstr("cam1: this recording would not determine the focal "
                        "length or principal point: expected sigma of cam1.fv (5 px)"));
}

TEST(ExpectedIntrinsics, WithoutACovarianceNothingShows) {
  const std::vector<ExpectedSigma> expected = ExpectedIntrinsics("cam0", {}, {});
  ASSERT_FALSE(expected.empty());
  EXPECT_TRUE(std::isnan(expected[0].sigma));
  EXPECT_EQ(expected[0].verdict, Verdict::kInconclusive);
}

}  // namespace
}  // namespace calibrato
