#include "calibrato/sensors/lens_residual.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

constexpr Resolution kResolution{640, 480};

// The mean over all pixels is the sum that the scale was derived from as an integral: cosines of
// whole half waves at the middles of n pixels are orthogonal there too.
TEST(LensField, HasTheStatedRootMeanSquareInEachCoordinate) {
  constexpr Resolution kSmall{160, 120};
  for (const int64_t seed : {0, 1, 2}) {
    const LensField field({.rms_px = 0.1, .seed = seed}, kSmall);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Vector2d squares = Eigen::Vector2d::Zero();
    for (int v = 0; v < kSmall.height; ++v) {
      for (int u = 0; u < kSmall.width; ++u) {
        const Eigen::Vector2d d = field.At({u, v});
        sum += d;
        squares += d.cwiseAbs2();
      }
    }
    const double n = 1.0 * kSmall.width * kSmall.height;
    EXPECT_NEAR(std::sqrt(squares.x() / n), 0.1, 1e-9);
    EXPECT_NEAR(std::sqrt(squares.y() / n), 0.1, 1e-9);
    EXPECT_LT(sum.norm() / n, 1e-9);
  }
}

TEST(LensField, IsSmooth) {
  const LensField field({.rms_px = 0.2, .seed = 3}, kResolution);
  // Five half waves of a few rms along 480 px turn by less than 0.02 px per px.
  for (int u = -20; u < 660; u += 10) {
    EXPECT_LT((field.At({u + 1.0, 77.0}) - field.At({u, 77.0})).norm(), 0.02);
  }
}

TEST(LensField, IsAnotherOneForAnotherSeedAndNoneByDefault) {
  const Eigen::Vector2d pixel(100.0, 50.0);
  const LensField first({.rms_px = 0.1, .seed = 1}, kResolution);
  const LensField same({.rms_px = 0.1, .seed = 1}, kResolution);
  const LensField other({.rms_px = 0.1, .seed = 2}, kResolution);
  EXPECT_EQ(first.At(pixel), same.At(pixel));
  EXPECT_NE(first.At(pixel), other.At(pixel));
  EXPECT_EQ(LensField().At(pixel), Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(LensField({.rms_px = 0.0, .seed = 1}, kResolution).At(pixel),
            Eigen::Vector2d(0.0, 0.0));
}

TEST(LensResidual, ReadsBackAndNamesWhatIsWrong) {
  const LensResidual read = LensResidualFromValue(
      ParseYaml(ToYaml(ToValue(LensResidual{.rms_px = 0.15, .seed = 7})), "rig.yaml"), nullptr);
  EXPECT_EQ(read.rms_px, 0.15);
  EXPECT_EQ(read.seed, 7);
  for (const char* text : {"rms_px: -0.1", "rms_px: 11", "rms_px: .nan", "seed: -1", "seed: 1.5"}) {
    EXPECT_THROW((void)LensResidualFromValue(ParseYaml(text, "rig.yaml"), nullptr), InputError)
        << text;
  }
}

}  // namespace
}  // namespace calibrato
