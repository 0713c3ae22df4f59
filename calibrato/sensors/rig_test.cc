#include "calibrato/sensors/rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

Rig MakeRig() {
  Eigen::VectorXd parameters(4);
  parameters << 585.7561, 585.7561, 320.5, 240.5;
  Rig rig;
  rig.cameras = {
      Camera{CameraModel("pinhole-none", parameters), {640, 480}, "/cam0/image_raw", std::nullopt}};
  rig.T_e_c0 = {ExpSo3({0.1, 0.0, 0.7}), {0.02, 0.03, 0.16}};
  rig.T_c0_i = {ExpSo3({0.0, 0.0, 1.5708}), {0.06, 0.0, -0.1}};
  rig.time_offset_i_c = Duration::FromNanoseconds(7300000);
  rig.board = Checkerboard{6, 7, 0.06, 0.06};
  rig.T_w_g = {ExpSo3({1.0, 2.0, 0.5}), {-2.0, -0.5, 0.7}};
  rig.exposure_s = 0.005;
  rig.camera_rate_hz = 25.0;
  rig.corner_noise.stddev_px = 0.2;
  rig.corner_noise.blur_knee_px = 4.5;
  rig.arm_limits.joint_upper = Eigen::Matrix<double, 7, 1>::Constant(2.5);
  rig.arm_limits.max_wrist_turn = 1.5;
  rig.arm_limits.keep_out = {{"lamp", {ExpSo3({0.0, 0.3, 0.0}), {0.5, 0.5, 0.5}}, {0.1, 0.2, 0.3}}};
  rig.corner_noise.phase_error_px = 0.04;
  rig.lens_residual = {.rms_px = 0.1, .seed = 5};
  rig.stand_motion_m = 2e-4;
  rig.finger_reach_m = 0.2;
  rig.image_disturbances.line_delay_s = 3e-5;
  rig.image_disturbances.exposure_variation = 0.5;
  rig.image_disturbances.lighting_gradient = {0.1, -0.2};
  rig.arm_disturbances = {.mode_hz = 17.0, .mode_damping = 0.1, .torque_ripple = 0.3};
  return rig;
}

TEST(Rig, RoundTrip) {
  std::vector<std::string> warnings;
  const std::string text = ToYaml(ToValue(MakeRig()));
  const Rig rig = RigFromValue(ParseYaml(text, "rig.yaml"), &warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  EXPECT_LT((rig.T_w_g.R - MakeRig().T_w_g.R).norm(), 1e-14);
  EXPECT_EQ(rig.time_offset_i_c, Duration::FromNanoseconds(7300000));
  EXPECT_EQ(rig.board, MakeRig().board);
  EXPECT_EQ(rig.corner_noise.stddev_px, 0.2);
  EXPECT_EQ(rig.exposure_s, 0.005);
  EXPECT_EQ(rig.corner_noise.blur_knee_px, 4.5);
  EXPECT_EQ(rig.arm_limits.joint_upper, MakeRig().arm_limits.joint_upper);
  EXPECT_FALSE(rig.arm_limits.joint_lower.allFinite());
  EXPECT_EQ(rig.arm_limits.max_wrist_turn, 1.5);
  ASSERT_EQ(rig.arm_limits.keep_out.size(), 1u);
  EXPECT_EQ(rig.arm_limits.keep_out[0].name, "lamp");
  EXPECT_EQ(rig.arm_limits.keep_out[0].size_m, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(rig.corner_noise.phase_error_px, 0.04);
  EXPECT_EQ(rig.lens_residual.rms_px, 0.1);
  EXPECT_EQ(rig.lens_residual.seed, 5);
  EXPECT_EQ(rig.stand_motion_m, 2e-4);
  EXPECT_EQ(rig.finger_reach_m, 0.2);
  EXPECT_EQ(rig.image_disturbances.line_delay_s, 3e-5);
  EXPECT_EQ(rig.image_disturbances.exposure_variation, 0.5);
  EXPECT_EQ(rig.image_disturbances.lighting_gradient, Eigen::Vector2d(0.1, -0.2));
  EXPECT_EQ(rig.arm_disturbances.mode_hz, 17.0);
  EXPECT_EQ(rig.arm_disturbances.mode_damping, 0.1);
  EXPECT_EQ(rig.arm_disturbances.torque_ripple, 0.3);
  EXPECT_EQ(rig.camera_rate_hz, 25.0);
}

TEST(Rig, WhatIsOptionalHasDefaults) {
  Value value = ToValue(MakeRig());
  std::string text = ToYaml(value);
  text.erase(text.find("exposure_s"));
  const Rig rig = RigFromValue(ParseYaml(text, "rig.yaml"), nullptr);
  EXPECT_EQ(rig.exposure_s, 0.0);
  EXPECT_EQ(rig.camera_rate_hz, 10.0);
  EXPECT_EQ(rig.corner_noise.stddev_px, 0.1);
}

TEST(CornerNoise, GrowsSteeplyBeyondItsKnee) {
  CornerNoise noise{.stddev_px = 0.03, .blur_factor = 0.01};
  EXPECT_NEAR(noise.Stddev(4.0), 0.05, 1e-15);
  noise.blur_knee_px = 4.0;
  EXPECT_NEAR(noise.Stddev(4.0), std::hypot(0.03, 0.04 * std::sqrt(2.0)), 1e-15);
  // Far beyond, sixteen times as much at twice the blur.
  EXPECT_NEAR(noise.Stddev(80.0) / noise.Stddev(40.0), 16.0, 1e-3);
  EXPECT_EQ(noise.Stddev(0.0), 0.03);
}

// A file that ends too soon is an error of one line that names it, or, cut behind a whole key, a
// rig of which the rest has its defaults.
TEST(Rig, ATruncatedFileIsAnErrorOfOneLineOrARigWithDefaults) {
  const std::string text = ToYaml(ToValue(MakeRig()));
  int num_errors = 0;
  for (size_t length = 0; length < text.size(); length += 23) {
    try {
      const Rig rig = RigFromValue(ParseYaml(text.substr(0, length), "rig.yaml"), nullptr);
      EXPECT_EQ(rig.cameras.size(), 1u);
    } catch (const InputError& error) {
      ++num_errors;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("rig.yaml"), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(num_errors, 10);
}

TEST(Rig, SizesOfEffectsOutOfTheirRangeAreErrorsWithTheirKey) {
  const std::string text = ToYaml(ToValue(MakeRig()));
  for (const auto& [from, to, key] :
       {std::tuple("stand_motion_m: 2.0e-04", "stand_motion_m: 0.2", "stand_motion_m"),
        std::tuple("finger_reach_m: 0.2", "finger_reach_m: -1", "finger_reach_m"),
        std::tuple("phase_error_px: 0.04", "phase_error_px: .nan", "phase_error_px"),
        std::tuple("rms_px: 0.1", "rms_px: 100", "rms_px"),
        // 480 rows of 9e-5 s take longer than one of 25 images a second.
        std::tuple("line_delay_s: 3.0e-05", "line_delay_s: 9.0e-05", "line_delay_s"),
        std::tuple("exposure_variation: 0.5", "exposure_variation: 1.1", "exposure_variation")}) {
    std::string changed = text;
    const size_t at = changed.find(from);
    ASSERT_NE(at, std::string::npos) << from << " in\n" << text;
    changed.replace(at, std::string(from).size(), to);
    try {
      (void)RigFromValue(ParseYaml(changed, "rig.yaml"), nullptr);
      FAIL() << to;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
    }
  }
}

TEST(Rig, JointLimitsOfSomeJointsReadBack) {
  Rig rig = MakeRig();
  rig.arm_limits = {};
  rig.arm_limits.joint_lower[3] = -2.0;
  rig.arm_limits.joint_upper[6] = 1.0;
  const Rig read = RigFromValue(ParseYaml(ToYaml(ToValue(rig)), "rig.yaml"), nullptr);
  EXPECT_EQ(read.arm_limits.joint_lower, rig.arm_limits.joint_lower);
  EXPECT_EQ(read.arm_limits.joint_upper, rig.arm_limits.joint_upper);
}

TEST(Rig, AnArmThatSwingsFasterThanItIsSimulatedIsAnError) {
  std::string text = ToYaml(ToValue(MakeRig()));
  const std::string value = "mode_hz: 17";
  text.replace(text.find(value), value.size(), "mode_hz: 170");
  EXPECT_THROW((void)RigFromValue(ParseYaml(text, "rig.yaml"), nullptr), InputError);
}

TEST(Rig, ARateThatNoCameraHasIsAnErrorWithLineAndKey) {
  for (const char* rate : {"0", "-10", "1e-12", "0.009", "1001", ".nan"}) {
    Value value = ToValue(MakeRig());
    std::string text = ToYaml(value);
    const std::string key = "\nrate_hz: 25";
    ASSERT_NE(text.find(key), std::string::npos) << text;
    text.replace(text.find(key), key.size(), std::string("\nrate_hz: ") + rate);
    try {
      (void)RigFromValue(ParseYaml(text, "rig.yaml"), nullptr);
      FAIL() << rate;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("rate_hz"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("line"), std::string::npos) << error.what();
    }
  }
}

TEST(Rig, ANegativeDensityIsAnErrorWithLineAndKey) {
  std::string text = ToYaml(ToValue(MakeRig()));
  const std::string key = "gyroscope_noise_density: ";
  text.insert(text.find(key) + key.size(), "-");
  try {
    (void)RigFromValue(ParseYaml(text, "rig.yaml"), nullptr);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("imu.gyroscope_noise_density"), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("line"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace calibrato
