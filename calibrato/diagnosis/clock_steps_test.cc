#include "calibrato/diagnosis/clock_steps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

// Speed of a rig that never turns alike twice.
double Speed(double t) {
  return std::abs(1.0 + std::sin(1.1 * t) + 0.7 * std::sin(2.9 * t + 1.0) +
                  0.4 * std::sin(0.31 * t * t));
}

Time At(double t) { return Time() + Duration::FromSeconds(t); }

// The gyroscope's clock is ahead by `early_s`, from 10 s on by `late_s`.
std::vector<ClockOffset> Offsets(double early_s, double late_s) {
  std::vector<RotationSpeed> camera;
  for (int k = 0; k < 400; ++k) {
    const double t = 2.0 + 0.05 * k;
    camera.push_back({At(t), At(t + 0.05), Speed(t + 0.025)});
  }
  std::vector<VectorSample> gyro;
  for (int k = 0; k < 5000; ++k) {
    const double t = 0.005 * k;
    gyro.push_back({At(t + (t < 12.0 ? early_s : late_s)), {0.6 * Speed(t), 0.0, 0.8 * Speed(t)}});
  }
  return ClockOffsets(camera, gyro, 0.0);
}

TEST(ClockOffsets, AreTheSameAllAlongForGoodClocks) {
  const auto offsets = Offsets(0.13, 0.13);
  ASSERT_EQ(offsets.size(), 5U);
  for (const ClockOffset& offset : offsets) {
    EXPECT_NEAR(offset.comparison.time_offset_s, 0.13, 0.011);
    EXPECT_GT(offset.comparison.correlation, 0.99);
  }
  EXPECT_TRUE(FindingsOnClockSteps("cam0", "imu0", offsets).empty());
}

TEST(ClockOffsets, StepWhereAClockWasSet) {
  const auto findings = FindingsOnClockSteps("cam0", "imu0", Offsets(0.0, 0.4));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Severity::kFail);
  EXPECT_THAT(findings[0].what, testing::HasSubstr("by 0.40 s from"));
}

// Loops of 1.2 s that are all alike: pieces fit at every whole number of loops.
double SpeedOfLoops(double t) {
  const double phase = 2.0 * std::numbers::pi * t / 1.2;
  return 1.0 + 0.6 * std::sin(phase) + 0.3 * std::sin(2.0 * phase + 1.0);
}

// With noise of the camera, which decides where they fit best.
std::vector<RotationSpeed> CameraOnLoops(uint64_t seed) {
  Rng rng(seed);
  std::vector<RotationSpeed> camera;
  for (int k = 0; k < 400; ++k) {
    const double t = 2.0 + 0.05 * k;
    camera.push_back({At(t), At(t + 0.05), SpeedOfLoops(t + 0.025) + 0.05 * rng.Normal()});
  }
  return camera;
}

std::vector<VectorSample> GyroOnLoops(uint64_t seed, double offset_s) {
  Rng rng(1000 + seed);
  std::vector<VectorSample> gyro;
  for (int k = 0; k < 5000; ++k) {
    const double t = 0.005 * k;
    gyro.push_back({At(t + offset_s), {SpeedOfLoops(t) + 0.05 * rng.Normal(), 0.0, 0.0}});
  }
  return gyro;
}

TEST(ClockOffsets, DoNotStepWhereAMotionRepeatsItself) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<RotationSpeed> camera = CameraOnLoops(seed);
    const std::vector<VectorSample> gyro = GyroOnLoops(seed, 0.13);
    const auto whole = CompareSpeeds(camera, gyro);
    ASSERT_TRUE(whole.has_value());
    EXPECT_NEAR(whole->time_offset_s, 0.13, 0.021) << seed;
    const auto offsets = ClockOffsets(camera, gyro, whole->time_offset_s);
    ASSERT_EQ(offsets.size(), 5U);
    for (const ClockOffset& offset : offsets) {
      EXPECT_NEAR(offset.comparison.time_offset_s, 0.13, 0.031) << seed;
    }
    EXPECT_TRUE(FindingsOnClockSteps("cam0", "imu0", offsets).empty()) << seed;
  }
}

// The peak is taken as high as it is, not its flank that is nearer to the centre.
TEST(CompareSpeeds, FindsAnOffsetFarFromTheCentre) {
  std::vector<RotationSpeed> camera;
  std::vector<VectorSample> gyro;
  Rng rng(5);
  for (int k = 0; k < 400; ++k) {
    const double t = 2.0 + 0.05 * k;
    camera.push_back({At(t), At(t + 0.05), Speed(t + 0.025) + 0.05 * rng.Normal()});
  }
  for (int k = 0; k < 5000; ++k) {
    const double t = 0.005 * k;
    gyro.push_back({At(t + 2.4), {Speed(t) + 0.05 * rng.Normal(), 0.0, 0.0}});
  }
  for (const double centre_s : {0.0, 2.0, 5.0}) {
    const auto comparison = CompareSpeeds(camera, gyro, centre_s);
    ASSERT_TRUE(comparison.has_value());
    EXPECT_NEAR(comparison->time_offset_s, 2.4, 0.011) << centre_s;
  }
}

TEST(ClockOffsets, NothingIsSaidWithoutMotion) { EXPECT_TRUE(ClockOffsets({}, {}, 0.0).empty()); }

}  // namespace
}  // namespace calibrato
