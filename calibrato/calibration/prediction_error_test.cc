#include "calibrato/calibration/prediction_error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};

CameraModel Pinhole(double fu, double fv, double pu, double pv) {
  return {"pinhole-none", Eigen::Vector4d(fu, fv, pu, pv)};
}

TEST(PredictionError, OfTheTruthIsZero) {
  EXPECT_NEAR(PredictionErrorPx(Pinhole(500, 510, 320, 240), Pinhole(500, 510, 320, 240), kImage),
              0.0, 1e-12);
}

TEST(PredictionError, OfAShiftedCentreIsTheShift) {
  EXPECT_NEAR(PredictionErrorPx(Pinhole(500, 500, 323, 244), Pinhole(500, 500, 320, 240), kImage),
              5.0, 1e-12);
}

TEST(PredictionError, OfAFocalLengthGrowsWithTheRadius) {
  // 1 % of the distance from the centre; mean squares of a uniform grid of n over a width w: w^2 /
  // 12 (1 - 1/n^2).
  const double expected = 0.01 * std::sqrt(640.0 * 640.0 / 12.0 * (1.0 - 1.0 / 256.0) +
                                           480.0 * 480.0 / 12.0 * (1.0 - 1.0 / 144.0));
  EXPECT_NEAR(
      PredictionErrorPx(Pinhole(505, 505, 319.5, 239.5), Pinhole(500, 500, 319.5, 239.5), kImage),
      expected, 1e-9);
}

}  // namespace
}  // namespace calibrato
