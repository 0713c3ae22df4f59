#include "calibrato/mdp/imu_entropy.h"

#include <gtest/gtest.h>

#include <cmath>

namespace calibrato {
namespace {

using Eigen::Vector3d;

TEST(ImuEntropy, IsZeroOfNothingAndOfRest) {
  EXPECT_EQ(ImuEntropy({}), 0.0);
  ImuStream rest;
  for (int k = 0; k < 100; ++k) {
    rest.gyro.push_back({Time(), Vector3d::Constant(0.01)});
    rest.accel.push_back({Time(), Vector3d(0.1, 0.1, 9.8)});
  }
  EXPECT_EQ(ImuEntropy(rest), 0.0);
}

// Two rates in equal parts: log 2; one channel of 64 bins used evenly: log 64.
TEST(ImuEntropy, IsThatOfItsHistograms) {
  ImuStream stream;
  for (int k = 0; k < 64; ++k) {
    stream.gyro.push_back({Time(), Vector3d(k % 2 == 0 ? -1.0 : 1.0, 0.01, 0.01)});
    stream.accel.push_back({Time(), Vector3d(-15.0 + 30.0 * (k + 0.5) / 64.0, 0.1, 0.1)});
  }
  EXPECT_NEAR(ImuEntropy(stream), std::log(2.0) + std::log(64.0), 1e-12);
  // Twice the time, the same spread: the same entropy.
  const ImuStream once = stream;
  stream.gyro.insert(stream.gyro.end(), once.gyro.begin(), once.gyro.end());
  stream.accel.insert(stream.accel.end(), once.accel.begin(), once.accel.end());
  EXPECT_NEAR(ImuEntropy(stream), ImuEntropy(once), 1e-12);
}

TEST(ImuEntropy, CountsWhatIsOutOfRangeAtItsEnds) {
  ImuStream stream;
  stream.gyro = {{Time(), Vector3d(99.0, 0.0, 0.0)}, {Time(), Vector3d(1.99, 0.0, 0.0)}};
  EXPECT_EQ(ImuEntropy(stream), 0.0);
}

}  // namespace
}  // namespace calibrato
