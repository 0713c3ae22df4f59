#include "calibrato/calibration/knot_spacing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

// Sines of one frequency in all axes, with the same noise in both sensors.
ImuStream Stream(double frequency_hz, double noise, double rate_hz = 200.0,
                 double duration_s = 20.0) {
  Rng rng(1);
  const auto sample = [&](double t) {
    const double value = std::sin(2.0 * std::numbers::pi * frequency_hz * t);
    const double x = rng.Normal();
    const double y = rng.Normal();
    return VectorSample{
        Time() + Duration::FromSeconds(t),
        Eigen::Vector3d::Constant(value) + noise * Eigen::Vector3d(x, y, rng.Normal())};
  };
  ImuStream stream;
  for (double t = 0.0; t < duration_s; t += 1.0 / rate_hz) {
    stream.gyro.push_back(sample(t));
    stream.accel.push_back(sample(t));
  }
  return stream;
}

TEST(KnotSpacing, IsFinerForFasterMotion) {
  const double slow = KnotSpacingFor(Stream(0.5, 0.01));
  const double fast = KnotSpacingFor(Stream(4.0, 0.01));
  // Eight times the frequency, an eighth of the spacing, to a step of sqrt(2) either way.
  EXPECT_NEAR(std::log2(slow / fast), 3.0, 0.6);
}

TEST(KnotSpacing, IsCoarserForNoisierSensors) {
  EXPECT_GT(KnotSpacingFor(Stream(1.0, 0.3)), KnotSpacingFor(Stream(1.0, 0.001)));
}

TEST(KnotSpacing, IsCoarseWhereNothingMoves) {
  EXPECT_NEAR(KnotSpacingFor(Stream(0.0, 0.01)), 0.4 / std::sqrt(2.0), 0.12);
}

TEST(KnotSpacing, LeavesTwoAndAHalfReadingsForEachCoefficient) {
  EXPECT_GT(KnotSpacingFor(Stream(40.0, 1e-6)), 2.5 / 200.0 / std::sqrt(2.0) * 0.99);
}

TEST(KnotSpacing, HasADefaultForShortStreams) { EXPECT_EQ(KnotSpacingFor({}), 0.1); }

TEST(KnotSpacing, IsNotMadeFineBySpikes) {
  const ImuStream clean = Stream(1.0, 0.01);
  ImuStream spiked = clean;
  for (size_t k = 50; k < 4000; k += 333) spiked.gyro[k].value.x() += 3.0;
  EXPECT_EQ(KnotSpacingFor(spiked), KnotSpacingFor(clean));
}

}  // namespace
}  // namespace calibrato
