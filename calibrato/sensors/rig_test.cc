#include "calibrato/sensors/rig.h"

#include <gtest/gtest.h>

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
