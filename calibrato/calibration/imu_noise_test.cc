#include "calibrato/calibration/imu_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kHour = 3600.0;

// Noise by its definition: white of density N has a standard deviation of N sqrt(rate) in each
// sample, a walk of density K steps by K sqrt(period).
std::vector<VectorSample> AtRest(const Vector3d& mean, double white, double walk, double rate_hz,
                                 double duration_s, Rng& rng) {
  const auto vector = [&]() -> Vector3d {
    const double x = rng.Normal();
    const double y = rng.Normal();
    return {x, y, rng.Normal()};
  };
  std::vector<VectorSample> samples;
  Vector3d bias = mean;
  const auto count = static_cast<int64_t>(duration_s * rate_hz);
  const auto period_ns = static_cast<int64_t>(1e9 / rate_hz);
  for (int64_t k = 0; k < count; ++k) {
    samples.push_back({Time::FromNanoseconds(1'000 + k * period_ns),
                       bias + white * std::sqrt(rate_hz) * vector()});
    bias += walk / std::sqrt(rate_hz) * vector();
  }
  return samples;
}

ImuStream Log(const ImuNoise& noise, double duration_s, uint64_t seed) {
  Rng rng(seed);
  return {AtRest({0.01, -0.02, 0.003}, noise.gyro_noise_density, noise.gyro_random_walk,
                 noise.rate_hz, duration_s, rng),
          AtRest({0.1, -0.2, 9.8}, noise.accel_noise_density, noise.accel_random_walk,
                 noise.rate_hz, duration_s, rng)};
}

// An IMU as of a phone, and the paper's, of which the walks show after 8, 190, 4 and 45 s.
const ImuNoise kPhone{200.0, 2e-3, 4e-4, 2e-4, 2e-5};

TEST(EstimateImuNoise, FindsTheDensitiesOfAThreeHourLogToTenPercent) {
  for (const ImuNoise& truth : {kPhone, ImuNoise()}) {
    const ImuNoiseEstimate estimate = EstimateImuNoise("imu0", Log(truth, 3.0 * kHour, 1));
    const ImuNoise found = estimate.noise();
    EXPECT_NEAR(found.rate_hz, 200.0, 1e-6);
    EXPECT_NEAR(found.gyro_noise_density / truth.gyro_noise_density, 1.0, 0.1);
    EXPECT_NEAR(found.accel_noise_density / truth.accel_noise_density, 1.0, 0.1);
    EXPECT_NEAR(found.gyro_random_walk / truth.gyro_random_walk, 1.0, 0.1);
    EXPECT_NEAR(found.accel_random_walk / truth.accel_random_walk, 1.0, 0.1);
    EXPECT_THAT(estimate.warnings, IsEmpty());
    EXPECT_FALSE(estimate.gyro.walk.is_upper_bound);
  }
}

// The errors that are stated are those that are made. A slow IMU makes long logs cheap.
TEST(EstimateImuNoise, StatesItsErrorsAsTheyAre) {
  const int num_logs = FullSample() ? 300 : 40;
  const ImuNoise truth{20.0, 2e-3, 4e-4, 2e-4, 2e-5};
  double white = 0.0;
  double walk = 0.0;
  for (int n = 0; n < num_logs; ++n) {
    const ImuNoiseEstimate estimate =
        EstimateImuNoise("imu0", Log(truth, kHour, 100 + static_cast<uint64_t>(n)));
    const auto add = [](const NoiseFigure& figure, double density, double* sum) {
      const double error = figure.value / density - 1.0;
      *sum += std::pow(error / figure.relative_sigma, 2);
    };
    add(estimate.gyro.white, truth.gyro_noise_density, &white);
    add(estimate.accel.walk, truth.accel_random_walk, &walk);
  }
  // Means of chi-square of one degree; for white noise the model's allowance is on top.
  EXPECT_LT(white / num_logs, 1.0);
  EXPECT_NEAR(walk / num_logs, 1.0, FullSample() ? 0.45 : 0.75);
}

TEST(EstimateImuNoise, SaysWhatALogIsTooShortFor) {
  const ImuNoise truth;
  const ImuNoiseEstimate estimate = EstimateImuNoise("imu0", Log(truth, 60.0, 2));
  EXPECT_NEAR(estimate.gyro.white.value / truth.gyro_noise_density, 1.0, 0.1);
  EXPECT_TRUE(estimate.gyro.walk.is_upper_bound);
  EXPECT_GT(estimate.gyro.walk.value, truth.gyro_random_walk);
  EXPECT_THAT(estimate.warnings,
              testing::Contains(AllOf(HasSubstr("imu0 gyroscope: the log of 60 s is too short"),
                                      HasSubstr("random walk"))));
}

TEST(EstimateImuNoise, UsesTheLongestPieceBetweenGaps) {
  ImuStream stream = Log(kPhone, 100.0, 3);
  for (auto* samples : {&stream.gyro, &stream.accel}) {
    for (size_t k = 5'000; k < samples->size(); ++k) {
      (*samples)[k].stamp = (*samples)[k].stamp + Duration::FromSeconds(2.0);
    }
  }
  EXPECT_NEAR(EstimateImuNoise("imu0", stream).gyro.duration_s, 75.0, 0.01);
}

void ExpectRefused(const ImuStream& stream, const std::string& why) {
  try {
    (void)EstimateImuNoise("imu0", stream);
    ADD_FAILURE() << "not refused: " << why;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(why));
  }
}

// One stamp of another clock costs one sample, wherever it stands.
TEST(EstimateImuNoise, BearsAStrayStamp) {
  ImuStream log = Log(kPhone, 100.0, 6);
  const double expected = EstimateImuNoise("imu0", log).gyro.white.value;
  log.gyro[10].stamp = log.gyro[10].stamp + Duration::FromSeconds(1e9);
  const ImuNoiseEstimate estimate = EstimateImuNoise("imu0", log);
  EXPECT_NEAR(estimate.gyro.white.value, expected, 1e-2 * expected);
  EXPECT_GT(estimate.gyro.duration_s, 99.0);
}

// A hand that turns it slowly: neighbouring seconds hardly differ.
TEST(EstimateImuNoise, RefusesASlowTilt) {
  ImuStream log = Log(kPhone, 300.0, 7);
  for (VectorSample& sample : log.accel) {
    const double angle = 0.01 * (sample.stamp - log.accel.front().stamp).seconds();
    sample.value += 9.8 * Vector3d(std::sin(angle), 0.0, std::cos(angle) - 1.0);
  }
  try {
    (void)EstimateImuNoise("imu0", log);
    FAIL() << "was taken for lying still";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the IMU was moved, imu0 accelerometer"));
    EXPECT_THAT(error.what(), HasSubstr("drifts by"));
  }
}

TEST(EstimateImuNoise, RefusesWhatTellsNoNoise) {
  ImuStream moved = Log(kPhone, 60.0, 4);
  for (size_t k = 6'000; k < 6'400; ++k) moved.gyro[k].value.y() += 0.3;
  ExpectRefused(moved, "the IMU was moved, imu0 gyroscope");
  ExpectRefused(Log(kPhone, 5.0, 5), "too short a log, imu0 gyroscope");
  ImuStream stuck = Log(kPhone, 60.0, 6);
  for (VectorSample& sample : stuck.accel) sample.value.z() = 9.8;
  ExpectRefused(stuck, "a sensor that never changes, imu0 accelerometer");
  ExpectRefused({}, "too short a log");
}

// Flat where bias instability is: of three axes with a fourth of their variance as flicker, made of
// Gauss-Markov processes an octave apart.
TEST(EstimateImuNoise, SeesBiasInstability) {
  Rng rng(8);
  ImuStream stream = Log({50.0, 1e-3, 1e-7, 1e-3, 1e-7}, 2.0 * kHour, 9);
  for (double time_constant_s = 0.25; time_constant_s < 4000.0; time_constant_s *= 2.0) {
    const double keep = std::exp(-1.0 / (50.0 * time_constant_s));
    Vector3d state = Vector3d::Zero();
    for (VectorSample& sample : stream.gyro) {
      const double x = rng.Normal();
      const double y = rng.Normal();
      state = keep * state + std::sqrt(1.0 - keep * keep) * 5e-4 * Vector3d(x, y, rng.Normal());
      sample.value += state;
    }
  }
  const ImuNoiseEstimate estimate = EstimateImuNoise("imu0", stream);
  for (const AxisNoise& axis : estimate.gyro.axes) {
    EXPECT_GT(axis.bias_instability, 2e-4);
    EXPECT_LT(axis.bias_instability, 1.2e-3);
  }
  for (const AxisNoise& axis : estimate.accel.axes) EXPECT_EQ(axis.bias_instability, 0.0);
}

}  // namespace
}  // namespace calibrato
