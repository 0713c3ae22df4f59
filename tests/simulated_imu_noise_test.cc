// What comes out of a simulated IMU is the noise that was asked for: found again by the Allan
// deviation, one test a figure.

#include <gtest/gtest.h>

#include <cstdio>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/calibration/imu_noise.h"
#include "calibrato/simulation/imu_simulation.h"

namespace calibrato {
namespace {

ImuMotion AtRest(double /*t_s*/) {
  return {Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
          Eigen::Vector3d::Zero()};
}

// The paper's IMU lying still for four hours. The small sample lies still for five minutes, and has
// ten times the random walks, which would not show in so short a time.
struct Log {
  ImuNoise asked;
  ImuNoiseEstimate found;
};
const Log& RestingImu() {
  static const Log log = [] {
    Log made;
    if (!FullSample()) {
      made.asked.gyro_random_walk *= 10.0;
      made.asked.accel_random_walk *= 10.0;
    }
    Rng rng(12);
    const double duration_s = FullSample() ? 14'400.0 : 300.0;
    const SimulatedImu imu = SimulateImu(AtRest, duration_s, {0.0, 0.0, -kStandardGravity},
                                         made.asked, {}, Time::FromNanoseconds(1'000'000'000), rng);
    made.found = EstimateImuNoise("imu0", imu.stream);
    return made;
  }();
  return log;
}

// Within three of its sigmas, which are small enough to tell it from its double or its half.
void ExpectFound(const char* name, const NoiseFigure& found, double asked) {
  std::printf("%s: asked %.4g, found %.4g, relative sigma %.4f\n", name, asked, found.value,
              found.relative_sigma);
  EXPECT_FALSE(found.is_upper_bound);
  EXPECT_LT(found.relative_sigma, 0.15);
  EXPECT_NEAR(found.value / asked, 1.0, 3.0 * found.relative_sigma);
}

TEST(SimulatedImuNoise, WhiteNoiseOfTheGyroscopeIsWhatWasAskedFor) {
  ExpectFound("gyroscope, white", RestingImu().found.gyro.white,
              RestingImu().asked.gyro_noise_density);
}

TEST(SimulatedImuNoise, WhiteNoiseOfTheAccelerometerIsWhatWasAskedFor) {
  ExpectFound("accelerometer, white", RestingImu().found.accel.white,
              RestingImu().asked.accel_noise_density);
}

TEST(SimulatedImuNoise, RandomWalkOfTheGyroscopeIsWhatWasAskedFor) {
  ExpectFound("gyroscope, walk", RestingImu().found.gyro.walk, RestingImu().asked.gyro_random_walk);
}

TEST(SimulatedImuNoise, RandomWalkOfTheAccelerometerIsWhatWasAskedFor) {
  ExpectFound("accelerometer, walk", RestingImu().found.accel.walk,
              RestingImu().asked.accel_random_walk);
}

}  // namespace
}  // namespace calibrato
