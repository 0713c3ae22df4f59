#include "calibrato/sensors/imu_file.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/imu_disturbances.h"

namespace calibrato {
namespace {

constexpr const char* kGivenToKalibr = R"(rostopic: /imu_link
update_rate: 200.0
accelerometer_noise_density: 0.002
accelerometer_random_walk: 0.003
gyroscope_noise_density: 0.00017
gyroscope_random_walk: 0.00002
)";

std::vector<Imu> Parse(const std::string& text, std::vector<std::string>* warnings = nullptr) {
  return ImusFromValue(ParseYaml(text, "imu.yaml"), warnings);
}

Imu FaultyImu() {
  Imu imu;
  imu.model = ImuModelKind::kScaleMisalignmentSizeEffect;
  imu.intrinsics.M_accel << 1.01, 0.0, 0.0, 0.02, 0.99, 0.0, 0.03, -0.01, 1.0;
  imu.intrinsics.M_gyro << 0.98, 0.0, 0.0, -0.02, 1.03, 0.0, 0.01, 0.04, 1.02;
  imu.intrinsics.R_gyro_i = ExpSo3({0.01, -0.02, 0.03});
  imu.intrinsics.g_sensitivity << 1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4, 7e-4, 8e-4, 9e-4;
  imu.intrinsics.lever_arms_i.col(1) << 0.01, -0.02, 0.03;
  imu.intrinsics.lever_arms_i.col(2) << -0.02, 0.01, 0.005;
  imu.T_i_b = {ExpSo3({0.5, 0.6, 0.7}), {0.1, 0.2, 0.3}};
  imu.time_offset = Duration::FromNanoseconds(-1'500'000);
  imu.rostopic = "/second";
  return imu;
}

TEST(ImuFile, ReadsWhatKalibrIsGiven) {
  std::vector<std::string> warnings;
  const std::vector<Imu> imus = Parse(kGivenToKalibr, &warnings);
  ASSERT_EQ(imus.size(), 1U);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(imus[0].rostopic, "/imu_link");
  EXPECT_EQ(imus[0].noise.gyro_noise_density, 0.00017);
  EXPECT_EQ(imus[0].noise.gyro_random_walk, 0.00002);
  EXPECT_EQ(imus[0].noise.accel_noise_density, 0.002);
  EXPECT_EQ(imus[0].noise.accel_random_walk, 0.003);
  EXPECT_EQ(imus[0].noise.rate_hz, 200.0);
  EXPECT_EQ(imus[0].model, ImuModelKind::kCalibrated);
  EXPECT_EQ(ToYaml(ToValue(imus[0].noise, "/imu_link")).substr(0, 20), "rostopic: /imu_link\n");
}

TEST(ImuFile, RoundTripOfWhatKalibrWrites) {
  Imu scaled = FaultyImu();
  scaled.model = ImuModelKind::kScaleMisalignment;
  scaled.intrinsics.lever_arms_i.setZero();
  const std::vector<Imu> imus = {Imu(), FaultyImu(), scaled};
  const std::string text = ToYaml(ToValue(imus));
  std::vector<std::string> warnings;
  const std::vector<Imu> read = Parse(text, &warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(ToYaml(ToValue(read)), text);
  EXPECT_EQ(read[1].model, ImuModelKind::kScaleMisalignmentSizeEffect);
  EXPECT_EQ(read[1].intrinsics.M_gyro, FaultyImu().intrinsics.M_gyro);
  EXPECT_EQ(read[1].intrinsics.g_sensitivity, FaultyImu().intrinsics.g_sensitivity);
  EXPECT_EQ(read[1].intrinsics.lever_arms_i, FaultyImu().intrinsics.lever_arms_i);
  EXPECT_EQ(read[1].intrinsics.R_gyro_i, FaultyImu().intrinsics.R_gyro_i);
  EXPECT_EQ(read[1].time_offset, FaultyImu().time_offset);
  EXPECT_EQ(read[1].rostopic, "/second");
  EXPECT_EQ(text.find("rx_i"), text.rfind("rx_i"));  // of the second alone
}

TEST(ImuFile, ErrorsNameLineAndKey) {
  std::string text = kGivenToKalibr;
  text.replace(text.find("0.002"), 5, "0.0");
  std::string error = InputErrorOf([&] { Parse(text); });
  EXPECT_NE(error.find("line 3, key accelerometer_noise_density"), std::string::npos) << error;
  error = InputErrorOf([] { Parse("imu0:\n  update_rate: 100.0\n"); });
  EXPECT_NE(error.find("imu0"), std::string::npos) << error;
  error = InputErrorOf([] { Parse("cam0: {}\n"); });
  EXPECT_NE(error.find("unexpected key cam0"), std::string::npos) << error;
  error = InputErrorOf([] { Parse(std::string(kGivenToKalibr) + "model: scale-misalignmen\n"); });
  EXPECT_NE(error.find("did you mean scale-misalignment?"), std::string::npos) << error;
  error = InputErrorOf([] {
    Parse(std::string(kGivenToKalibr) +
          "accelerometers:\n  M: [[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]\n");
  });
  EXPECT_NE(error.find("line 8"), std::string::npos) << error;
  EXPECT_NE(error.find("lower triangle"), std::string::npos) << error;
  error = InputErrorOf([] {
    Parse(std::string(kGivenToKalibr) +
          "gyroscopes:\n  C_gyro_i: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]\n");
  });
  EXPECT_NE(error.find("bad rotation"), std::string::npos) << error;
  error = InputErrorOf(
      [] { Parse(std::string(kGivenToKalibr) + "accelerometers: {rx_i: [0.1, 0.0, 0.0]}\n"); });
  EXPECT_NE(error.find("bad lever arm"), std::string::npos) << error;
}

TEST(ImuFile, UnknownKeysAreWarnings) {
  std::vector<std::string> warnings;
  (void)Parse(std::string(kGivenToKalibr) + "update_rat: 3\ngyroscopes: {B: 1}\n", &warnings);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_NE((warnings[0] + warnings[1]).find("did you mean update_rate?"), std::string::npos);
}

TEST(ImuFile, ReadsAPublishedResultOfKalibr) {
  const char* data = std::getenv("CALIBRATO_DATA");
  if (data == nullptr) GTEST_SKIP() << "CALIBRATO_DATA is not set";
  std::vector<std::string> warnings;
  const std::vector<Imu> imus =
      ImusFromValue(ReadYaml(std::string(data) + "/kalibr_ref_tumvi/imu-imucalib.yaml"), &warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  ASSERT_EQ(imus.size(), 1U);
  EXPECT_EQ(imus[0].noise.accel_noise_density, 0.0028);
  EXPECT_EQ(imus[0].noise.gyro_random_walk, 2.2e-05);
  EXPECT_EQ(imus[0].model, ImuModelKind::kCalibrated);
}

TEST(ImuDisturbances, RoundTrip) {
  ImuDisturbances disturbances;
  disturbances.intrinsics = FaultyImu().intrinsics;
  disturbances.low_pass_hz = 40.0;
  disturbances.gyro_bias = {0.01, 0.02, 0.03};
  disturbances.accel_bias = {-0.1, 0.2, 0.3};
  disturbances.gyro_range = 8.7;
  disturbances.accel_resolution = 0.01;
  disturbances.clock_drift_ppm = -25.0;
  Value imu = Value::Object();
  SetImuDisturbances(disturbances, &imu);
  std::vector<std::string> warnings;
  const ImuDisturbances read =
      ImuDisturbancesFromValue(ParseYaml(ToYaml(imu), "rig.yaml"), &warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  Value again = Value::Object();
  SetImuDisturbances(read, &again);
  EXPECT_EQ(ToYaml(imu), ToYaml(again));
  EXPECT_EQ(read.gyro_bias, disturbances.gyro_bias);
  EXPECT_EQ(read.gyro_range, 8.7);
  EXPECT_EQ(read.accel_range, std::numeric_limits<double>::infinity());
  EXPECT_EQ(read.intrinsics.M_accel, disturbances.intrinsics.M_accel);
}

TEST(ImuDisturbances, AreOffUnlessAskedFor) {
  const ImuDisturbances off = ImuDisturbancesFromValue(Value::Object(), nullptr);
  EXPECT_EQ(off.intrinsics.M_accel, Eigen::Matrix3d::Identity());
  EXPECT_EQ(off.low_pass_hz, 0.0);
  EXPECT_EQ(off.clock_drift_ppm, 0.0);
  const std::string error = InputErrorOf([] {
    (void)ImuDisturbancesFromValue(ParseYaml("disturbances: {gyro_range_rad_s: 0}", "rig.yaml"),
                                   nullptr);
  });
  EXPECT_NE(error.find("gyro_range_rad_s"), std::string::npos) << error;
}

}  // namespace
}  // namespace calibrato
