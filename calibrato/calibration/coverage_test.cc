#include "calibrato/calibration/coverage.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/sensors/board.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};

// A frontal board of 100 x 80 px with its middle at (u, v), sheared so that one angle opens by
// `shear`.
BoardView ViewAt(double u, double v, double scale = 1.0, double shear = 0.0) {
  BoardView view;
  view.points_g = BoardPoints(Checkerboard{3, 6, 0.04, 0.02});
  view.pixels.resize(2, view.points_g.cols());
  for (Eigen::Index k = 0; k < view.points_g.cols(); ++k) {
    const double x = view.points_g(0, k) / 0.08 - 0.5;
    const double y = view.points_g(1, k) / 0.1 - 0.5;
    view.pixels.col(k) << u + scale * (100.0 * y + 80.0 * x * std::tan(shear)),
        v + scale * 80.0 * x;
  }
  return view;
}

TEST(ViewParameters, ByHand) {
  const double side = std::sqrt(8000.0);
  const ViewParameters p = ViewParametersOf(ViewAt(200.0, 300.0), kImage);
  EXPECT_NEAR(p.x, (200.0 - side / 2) / (640.0 - side), 1e-12);
  EXPECT_NEAR(p.y, (300.0 - side / 2) / (480.0 - side), 1e-12);
  EXPECT_NEAR(p.size, std::sqrt(8000.0 / (640.0 * 480.0)), 1e-12);
  EXPECT_NEAR(p.skew, 0.0, 1e-12);
}

TEST(ViewParameters, SkewIsTwiceTheAngleFromARightOne) {
  EXPECT_NEAR(ViewParametersOf(ViewAt(300.0, 200.0, 1.0, 0.1), kImage).skew, 0.2, 1e-12);
  EXPECT_NEAR(ViewParametersOf(ViewAt(300.0, 200.0, 1.0, -0.1), kImage).skew, 0.2, 1e-12);
  EXPECT_EQ(ViewParametersOf(ViewAt(300.0, 200.0, 1.0, 0.7), kImage).skew, 1.0);
}

TEST(Coverage, OneViewCoversSizeAlone) {
  const Coverage coverage = CoverageOf({ViewAt(320.0, 240.0)}, kImage);
  EXPECT_EQ(coverage.x, 0.0);
  EXPECT_EQ(coverage.y, 0.0);
  EXPECT_NEAR(coverage.size, std::sqrt(8000.0 / (640.0 * 480.0)) / 0.4, 1e-12);
  EXPECT_NEAR(coverage.skew, 0.0, 1e-12);
}

TEST(Coverage, GrowsWithTheRangeAndStopsAtOne) {
  const double side = std::sqrt(8000.0);
  const Coverage half = CoverageOf({ViewAt(200.0, 240.0), ViewAt(300.0, 240.0)}, kImage);
  EXPECT_NEAR(half.x, 100.0 / (640.0 - side) / 0.7, 1e-12);
  EXPECT_EQ(half.y, 0.0);
  const Coverage full = CoverageOf({ViewAt(60.0, 50.0), ViewAt(580.0, 430.0)}, kImage);
  EXPECT_EQ(full.x, 1.0);
  EXPECT_EQ(full.y, 1.0);
  EXPECT_NEAR(full.sum(), 2.0 + full.size + full.skew, 1e-15);
}

TEST(Coverage, OfNothingIsZero) { EXPECT_EQ(CoverageOf({}, kImage).sum(), 0.0); }

}  // namespace
}  // namespace calibrato
