#include "calibrato/detection/saddle_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calibrato {
namespace {

constexpr int kSide = 41;

struct Picture {
  Eigen::Vector2d corner{20.3, 19.8};
  double angle_1 = 0.3;
  double angle_2 = 1.6;
  double blur_px = 0.9;
  Eigen::Vector2d curvature = Eigen::Vector2d::Zero();
  double half_contrast = 80.0;
};

// A bent edge, with the sine and cosine of its angle at hand.
struct DrawnEdge {
  double cosine;
  double sine;
  double curvature;

  double Distance(double u, double v) const {
    const double along = cosine * u + sine * v;
    return cosine * v - sine * u - 0.5 * curvature * along * along;
  }
};

// By quadrature over the surroundings of each pixel of black and white seen through a round blur:
// not what is fitted.
GreyImage Draw(const Picture& picture) {
  GreyImage image{{kSide, kSide}, {}};
  constexpr int kSamples = 40;
  std::vector<Eigen::Vector3d> samples;  // offset and weight
  double weights = 0.0;
  for (int i = 0; i < kSamples * kSamples; ++i) {
    const Eigen::Vector2d share((i % kSamples + 0.5) / kSamples - 0.5,
                                (i / kSamples + 0.5) / kSamples - 0.5);
    const double weight = std::exp(-0.5 * 64.0 * share.squaredNorm());
    samples.emplace_back(8.0 * picture.blur_px * share.x(), 8.0 * picture.blur_px * share.y(),
                         weight);
    weights += weight;
  }
  const DrawnEdge edge_1{std::cos(picture.angle_1), std::sin(picture.angle_1),
                         picture.curvature(0)};
  const DrawnEdge edge_2{std::cos(picture.angle_2), std::sin(picture.angle_2),
                         picture.curvature(1)};
  for (int v = 0; v < kSide; ++v) {
    for (int u = 0; u < kSide; ++u) {
      double sum = 0.0;
      for (const Eigen::Vector3d& sample : samples) {
        const double x = u + sample.x() - picture.corner.x();
        const double y = v + sample.y() - picture.corner.y();
        const bool is_bright = (edge_1.Distance(x, y) > 0.0) == (edge_2.Distance(x, y) > 0.0);
        sum += is_bright ? sample.z() : -sample.z();
      }
      const double brightness = 120.0 + picture.half_contrast * sum / weights;
      image.pixels.push_back(static_cast<uint8_t>(std::lround(brightness)));
    }
  }
  return image;
}

SaddleWindow WindowOf(const Picture& picture, double reach) {
  SaddleWindow window;
  window.centre = picture.corner + Eigen::Vector2d(0.6, -0.5);
  window.arms.col(0) =
      reach * Eigen::Vector2d(std::cos(picture.angle_1), std::sin(picture.angle_1));
  window.arms.col(1) =
      reach * Eigen::Vector2d(std::cos(picture.angle_2), std::sin(picture.angle_2));
  return window;
}

SaddleFlaw FlawOf(const GreyImage& image, const SaddleWindow& window) {
  const auto fit = FitSaddle(image, window);
  EXPECT_TRUE(std::holds_alternative<SaddleFlaw>(fit));
  return std::holds_alternative<SaddleFlaw>(fit) ? std::get<SaddleFlaw>(fit) : SaddleFlaw{};
}

TEST(SaddleFit, FindsTheCrossingToAFiftiethOfAPixel) {
  for (const double angle_2 : {1.6, 1.0, 2.4, 0.8}) {
    Picture picture;
    picture.angle_2 = angle_2;
    const auto fit = FitSaddle(Draw(picture), WindowOf(picture, 9.0));
    ASSERT_TRUE(std::holds_alternative<SaddleFit>(fit)) << angle_2;
    EXPECT_LT((std::get<SaddleFit>(fit).pixel - picture.corner).norm(), 0.02) << angle_2;
    EXPECT_NEAR(std::get<SaddleFit>(fit).contrast, 160.0, 30.0);
  }
}

// Black and white seen without any blur: each pixel the mean over its area, by quadrature.
GreyImage DrawSharp(const Picture& picture) {
  GreyImage image{{kSide, kSide}, {}};
  const DrawnEdge edge_1{std::cos(picture.angle_1), std::sin(picture.angle_1), 0.0};
  const DrawnEdge edge_2{std::cos(picture.angle_2), std::sin(picture.angle_2), 0.0};
  constexpr int kSamples = 50;
  for (int v = 0; v < kSide; ++v) {
    for (int u = 0; u < kSide; ++u) {
      const double x = u - picture.corner.x();
      const double y = v - picture.corner.y();
      const bool is_even =
          std::min(std::abs(edge_1.Distance(x, y)), std::abs(edge_2.Distance(x, y))) > 0.8;
      const int num = is_even ? 1 : kSamples;
      int balance = 0;
      for (int i = 0; i < num * num; ++i) {
        const double dx = (i % num + 0.5) / num - 0.5;
        const double dy = (i / num + 0.5) / num - 0.5;
        balance +=
            (edge_1.Distance(x + dx, y + dy) > 0.0) == (edge_2.Distance(x + dx, y + dy) > 0.0) ? 1
                                                                                               : -1;
      }
      const double brightness = 120.0 + picture.half_contrast * balance / (num * num);
      image.pixels.push_back(static_cast<uint8_t>(std::lround(brightness)));
    }
  }
  return image;
}

// The grey of one row of pixels is all that tells the place of an edge along the rows.
TEST(SaddleFit, FindsTheCrossingOfSharpEdgesWhereverItLiesWithinAPixel) {
  for (const double turn : {0.0, 0.01, 0.05, 0.4}) {
    for (const double phase : {-0.4, -0.3, -0.2, -0.1, 0.0, 0.15, 0.25, 0.35, 0.45}) {
      Picture picture;
      picture.corner = {20.0 + phase, 20.0 - 0.7 * phase};
      picture.angle_1 = turn;
      picture.angle_2 = turn + 0.5 * std::numbers::pi;
      const auto fit = FitSaddle(DrawSharp(picture), WindowOf(picture, 9.0));
      ASSERT_TRUE(std::holds_alternative<SaddleFit>(fit)) << turn << " " << phase;
      EXPECT_LT((std::get<SaddleFit>(fit).pixel - picture.corner).norm(), 0.015)
          << turn << " " << phase;
    }
  }
}

TEST(SaddleFit, TellsWhichQuadrantIsDark) {
  Picture picture;
  EXPECT_TRUE(
      std::get<SaddleFit>(FitSaddle(Draw(picture), WindowOf(picture, 9.0))).is_dark_between);
  picture.half_contrast = -80.0;
  EXPECT_FALSE(
      std::get<SaddleFit>(FitSaddle(Draw(picture), WindowOf(picture, 9.0))).is_dark_between);
}

TEST(SaddleFit, IsNotMovedByTheToneCurveOrByLightFromOneSide) {
  Picture picture;
  GreyImage image = Draw(picture);
  for (int v = 0; v < kSide; ++v) {
    for (int u = 0; u < kSide; ++u) {
      uint8_t& pixel = image.pixels[static_cast<size_t>(v * kSide + u)];
      const double light = (1.0 + 0.004 * (u - 20) - 0.003 * (v - 20)) * pixel / 255.0;
      pixel = static_cast<uint8_t>(std::lround(255.0 * std::pow(std::min(1.0, light), 0.6)));
    }
  }
  const auto fit = FitSaddle(image, WindowOf(picture, 9.0));
  ASSERT_TRUE(std::holds_alternative<SaddleFit>(fit));
  EXPECT_LT((std::get<SaddleFit>(fit).pixel - picture.corner).norm(), 0.015);
}

TEST(SaddleFit, SaysHowKnownBendsOfTheEdgesMoveTheCorner) {
  Picture picture;
  picture.curvature = {0.01, -0.006};
  const auto fit = std::get<SaddleFit>(FitSaddle(Draw(picture), WindowOf(picture, 9.0)));
  const Eigen::Vector2d straight = fit.pixel - picture.corner;
  const Eigen::Vector2d bent = straight + fit.J_pixel_curvature * picture.curvature;
  EXPECT_GT(straight.norm(), 0.04);  // else there was nothing to mend
  EXPECT_LT(bent.norm(), 0.1 * straight.norm() + 0.005);
}

TEST(SaddleFit, IgnoresWhatLiesDeepInAQuadrantOutsideTheBand) {
  Picture picture;
  picture.angle_1 = 0.12;
  picture.angle_2 = 0.1 + 0.5 * std::numbers::pi;
  GreyImage image = Draw(picture);
  for (int v = 24; v < 30; ++v) {
    for (int u = 24; u < 30; ++u) image.pixels[static_cast<size_t>(v * kSide + u)] = 20;
  }
  SaddleWindow window = WindowOf(picture, 9.0);
  window.band = 0.3;
  const auto fit = FitSaddle(image, window);
  ASSERT_TRUE(std::holds_alternative<SaddleFit>(fit));
  EXPECT_LT((std::get<SaddleFit>(fit).pixel - picture.corner).norm(), 0.01);
}

TEST(SaddleFit, RejectsWindowsThatLeaveTheImage) {
  Picture picture;
  picture.corner = {5.0, 20.0};
  EXPECT_EQ(FlawOf(Draw(picture), WindowOf(picture, 9.0)), SaddleFlaw::kNearBorder);
}

TEST(SaddleFit, RejectsWhatIsNoCrossingOfTwoEdges) {
  Picture picture;
  const SaddleWindow window = WindowOf(picture, 9.0);
  GreyImage flat{{kSide, kSide}, std::vector<uint8_t>(kSide * kSide, 128)};
  EXPECT_EQ(FlawOf(flat, window), SaddleFlaw::kBadFit);

  GreyImage one_edge = flat;
  for (int v = 20; v < kSide; ++v) {
    for (int u = 0; u < kSide; ++u) one_edge.pixels[static_cast<size_t>(v * kSide + u)] = 30;
  }
  EXPECT_EQ(FlawOf(one_edge, window), SaddleFlaw::kBadFit);

  Picture faint;
  faint.half_contrast = 2.0;
  EXPECT_EQ(FlawOf(Draw(faint), window), SaddleFlaw::kBadFit);
  EXPECT_EQ(FlawOf(Draw(picture), WindowOf(picture, 1.5)), SaddleFlaw::kBadFit);  // too small
}

}  // namespace
}  // namespace calibrato
