#include "calibrato/diagnosis/image_quality.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace calibrato {
namespace {

using testing::HasSubstr;

constexpr Resolution kSize{320, 240};
constexpr int kSquare = 30;
const Board kBoard = Checkerboard{5, 7, 0.03, 0.03};

// Squares of 30 px over all of the image, smeared along u by a motion of so many pixels.
GreyImage Squares(double black, double white, int smear) {
  GreyImage image{kSize, {}};
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) {
      double sum = 0.0;
      for (int k = 0; k < smear; ++k) {
        const int column = (u + k - smear / 2 + kSquare) / kSquare;
        sum += (column + v / kSquare) % 2 == 0 ? black : white;
      }
      image.pixels.push_back(static_cast<uint8_t>(sum / smear));
    }
  }
  return image;
}

// Corners lie between pixels, half a pixel before the first one of a square.
BoardView Corners() {
  BoardView view;
  view.pixels.resize(2, 35);
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 7; ++column) {
      const int id = row * 7 + column;
      view.corner_ids.push_back(id);
      view.pixels.col(id) << kSquare * (column + 1) - 0.5, kSquare * (row + 1) - 0.5;
    }
  }
  return view;
}

TEST(SharpnessOf, IsOnePixelForAPerfectEdge) {
  const auto sharp = SharpnessOf(Squares(30, 200, 1), Corners(), kBoard);
  ASSERT_TRUE(sharp.has_value());
  EXPECT_NEAR(sharp->edge_width_px, 1.0, 0.05);
  EXPECT_NEAR(sharp->black, 30.0, 1.0);
  EXPECT_NEAR(sharp->white, 200.0, 1.0);
}

TEST(SharpnessOf, IsTheLengthOfAMotionAcrossTheEdges) {
  const auto smeared = SharpnessOf(Squares(30, 200, 8), Corners(), kBoard);
  ASSERT_TRUE(smeared.has_value());
  EXPECT_NEAR(smeared->edge_width_px, 8.0, 0.4);
}

TEST(SharpnessOf, NothingIsSaidOfCirclesNorOfSmallSquares) {
  EXPECT_FALSE(
      SharpnessOf(Squares(30, 200, 1), Corners(), CircleGrid{5, 7, 0.03, false}).has_value());
  BoardView small = Corners();
  small.pixels *= 0.3;
  EXPECT_FALSE(SharpnessOf(Squares(30, 200, 1), small, kBoard).has_value());
}

std::vector<ImageQuality> Twenty(const GreyImage& image) {
  return std::vector<ImageQuality>(
      20, {Time(), BrightnessOf(image), SharpnessOf(image, Corners(), kBoard)});
}

TEST(FindingsOnImages, GoodImagesHaveNone) {
  EXPECT_TRUE(FindingsOnImages("cam0", Twenty(Squares(30, 200, 2)), kSize).empty());
}

TEST(FindingsOnImages, NameBlurLightAndDarkness) {
  const auto only = [](const GreyImage& image) {
    const auto findings = FindingsOnImages("cam0", Twenty(image), kSize);
    EXPECT_EQ(findings.size(), 1U);
    return findings.empty() ? "" : findings[0].what;
  };
  EXPECT_THAT(only(Squares(30, 200, 8)), HasSubstr("cam0: in 20 of 20"));
  EXPECT_THAT(only(Squares(30, 200, 8)), HasSubstr("blurred"));
  EXPECT_THAT(only(Squares(30, 255, 1)), HasSubstr("end of the sensor's range"));
  EXPECT_THAT(only(Squares(30, 60, 1)), HasSubstr("differ by less than 40"));
}

TEST(FindingsOnImages, NameAnImageOfNothing) {
  const std::vector<ImageQuality> dark(20, {Time(), 3.0, std::nullopt});
  EXPECT_THAT(FindingsOnImages("cam0", dark, kSize)[0].what, HasSubstr("all but black"));
}

}  // namespace
}  // namespace calibrato
