#include "calibrato/calibration/rate_alignment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

constexpr double kOffset = 0.3337;  // [s]
const Vector3d kBias(0.02, -0.03, 0.01);
const Eigen::Matrix3d kRotation = ExpSo3({0.5, -1.2, 2.0});

// The integral of the body's rates in frame i, in closed form.
Vector3d TurnAt(double t) {
  return {0.3 * std::sin(3.1 * t), 0.2 * std::cos(4.7 * t), 0.25 * std::sin(2.2 * t + 1.0)};
}
Vector3d RateAt(double t) {
  return {0.93 * std::cos(3.1 * t), -0.94 * std::sin(4.7 * t), 0.55 * std::cos(2.2 * t + 1.0)};
}

std::vector<RateSample> Gyro(double duration) {
  std::vector<RateSample> gyro;
  for (double t = 0.0; t < duration; t += 0.005) gyro.push_back({t, RateAt(t) + kBias});
  return gyro;
}

// Seen by sensor c at 20 Hz, whose clock is behind by the offset.
std::vector<RateInterval> Intervals(double begin, double end) {
  std::vector<RateInterval> intervals;
  for (double t = begin; t + 0.05 < end; t += 0.05) {
    const double t_i = t + kOffset;
    intervals.push_back({t, t + 0.05, kRotation * (TurnAt(t_i + 0.05) - TurnAt(t_i)) / 0.05});
  }
  return intervals;
}

TEST(AlignRates, FindsOffsetRotationAndBias) {
  const auto alignment = AlignRates(Intervals(0.0, 10.0), Gyro(10.0), 1.0);
  ASSERT_TRUE(alignment.has_value());
  EXPECT_NEAR(alignment->time_offset_s, kOffset, 2e-4);
  EXPECT_LT(LogSo3(alignment->R_c_i * kRotation.transpose()).norm(), 1e-3);
  EXPECT_LT((alignment->gyro_bias - kBias).norm(), 1e-3);
  EXPECT_GT(alignment->correlation, 0.999);
}

TEST(AlignRates, BearsNoise) {
  std::vector<RateInterval> intervals = Intervals(0.0, 10.0);
  Rng rng(1);
  for (RateInterval& interval : intervals) {
    interval.rate += 0.1 * Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
  }
  const auto alignment = AlignRates(intervals, Gyro(10.0), 1.0);
  ASSERT_TRUE(alignment.has_value());
  EXPECT_NEAR(alignment->time_offset_s, kOffset, 5e-3);
  EXPECT_LT(LogSo3(alignment->R_c_i * kRotation.transpose()).norm(), 0.05);
}

TEST(AlignRates, HoldsTheOffsetWhereItIsToldTo) {
  const auto alignment = AlignRates(Intervals(0.0, 10.0), Gyro(10.0), 0.0);
  ASSERT_TRUE(alignment.has_value());
  EXPECT_EQ(alignment->time_offset_s, 0.0);
}

TEST(AlignRates, GivesNothingWithoutOverlapOrRotation) {
  EXPECT_FALSE(AlignRates(Intervals(20.0, 30.0), Gyro(10.0), 1.0).has_value());
  EXPECT_FALSE(AlignRates(Intervals(0.0, 0.2), Gyro(10.0), 1.0).has_value());
  EXPECT_FALSE(AlignRates(Intervals(0.0, 5.0), {}, 1.0).has_value());
  std::vector<RateInterval> still = Intervals(0.0, 5.0);
  for (RateInterval& interval : still) interval.rate.setZero();
  EXPECT_FALSE(AlignRates(still, Gyro(10.0), 1.0).has_value());
}

}  // namespace
}  // namespace calibrato
