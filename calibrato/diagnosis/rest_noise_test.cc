#include "calibrato/diagnosis/rest_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

constexpr double kRate = 200.0;
constexpr double kGyroDensity = 1e-4;
constexpr double kAccelDensity = 2e-3;

// Moves, rests from 4 s to 7 s, moves on.
ImuStream Stream(double tremor_of_rest) {
  Rng rng(5);
  ImuStream stream;
  for (int k = 0; k < 2400; ++k) {
    const double t = k / kRate;
    const double size = t >= 4.0 && t < 7.0 ? tremor_of_rest : 1.0;
    const Eigen::Vector3d motion =
        size * Eigen::Vector3d(std::sin(6.0 * t), 0.3, std::cos(4.0 * t));
    const auto noise = [&](double density) -> Eigen::Vector3d {
      return density * std::sqrt(kRate) * Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
    };
    const Time stamp = Time::FromNanoseconds(int64_t{k} * 5'000'000);
    stream.gyro.push_back(
        {stamp, Eigen::Vector3d(0.01, 0.0, -0.02) + motion + noise(kGyroDensity)});
    stream.accel.push_back(
        {stamp, Eigen::Vector3d(0.0, 0.0, 9.8) + 3.0 * motion + noise(kAccelDensity)});
  }
  return stream;
}

TEST(NoiseAtRest, IsThatOfTheRestBetweenTwoMotions) {
  const auto noise = NoiseAtRest(Stream(0.0));
  ASSERT_TRUE(noise.has_value());
  EXPECT_NEAR(noise->begin.nanoseconds() * 1e-9, 4.1, 0.11);
  EXPECT_NEAR(noise->duration_s, 2.8, 0.11);
  // 3 x 600 differences: 2 % of the density.
  EXPECT_NEAR(noise->gyro_noise_density, kGyroDensity, 0.08 * kGyroDensity);
  EXPECT_NEAR(noise->accel_noise_density, kAccelDensity, 0.08 * kAccelDensity);
}

TEST(NoiseAtRest, AHandThatHoldsStillIsNoRest) {
  EXPECT_FALSE(NoiseAtRest(Stream(0.03)).has_value());
}

TEST(NoiseAtRest, NothingIsSaidOfAFewSamples) {
  EXPECT_FALSE(NoiseAtRest({}).has_value());
  ImuStream stream = Stream(0.0);
  stream.gyro.resize(1);
  EXPECT_FALSE(NoiseAtRest(stream).has_value());
}

// Six seconds, ten days of nothing, six seconds: spans of all that time would take gigabytes.
TEST(NoiseAtRest, NothingIsSaidOfClocksThatJump) {
  ImuStream stream = Stream(0.0);
  for (std::vector<VectorSample>* samples : {&stream.gyro, &stream.accel}) {
    for (size_t k = 1200; k < samples->size(); ++k) {
      (*samples)[k].stamp = (*samples)[k].stamp + Duration::FromSeconds(900'000.0);
    }
  }
  EXPECT_FALSE(NoiseAtRest(stream).has_value());
}

TEST(FindingsOnRestNoise, NameASensorThatIsNoisierThanStated) {
  const RestNoise found{Time(), 3.0, kGyroDensity, kAccelDensity};
  ImuNoise stated;
  stated.gyro_noise_density = 0.9 * kGyroDensity;
  stated.accel_noise_density = 0.1 * kAccelDensity;
  const auto findings = FindingsOnRestNoise("imu0", found, stated);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0].what,
              testing::HasSubstr("imu0 accelerometer: at rest its noise is 10.0 times"));
}

}  // namespace
}  // namespace calibrato
