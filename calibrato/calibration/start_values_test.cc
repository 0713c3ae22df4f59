#include "calibrato/calibration/start_values.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};
const Board kBoard = Checkerboard{6, 7, 0.03, 0.03};

CameraModel Lens(double f, double k1) {
  Eigen::VectorXd parameters(8);
  parameters << f, 1.02 * f, 330.0, 228.0, k1, 0.02, 0.0, 0.0;
  return {"pinhole-radtan", parameters};
}

TEST(StartValues, FindTheFocalLengthOfWideAndLongLenses) {
  for (const double f : {300.0, 585.0, 1000.0}) {
    for (const double k1 : {-0.25, 0.0, 0.1}) {
      Rng rng(7);
      const CameraModel truth = Lens(f, k1);
      const auto views = SyntheticViews(truth, kImage, kBoard, 20, 0.3, rng);
      const auto start = FindStartValues("pinhole-radtan", kImage, views);
      ASSERT_TRUE(start);
      EXPECT_EQ(start->used_views.size(), views.size());
      EXPECT_NEAR(start->state.model.parameters()(0), f, 0.2 * f) << "k1 " << k1;
    }
  }
}

TEST(StartValues, KeepWhatIsKnown) {
  Rng rng(8);
  const auto views = SyntheticViews(Lens(585.0, 0.0), kImage, kBoard, 5, 0.3, rng);
  Eigen::VectorXd known = Eigen::VectorXd::Constant(8, std::nan(""));
  known(2) = 300.0;
  known(4) = 0.01;
  const auto start = FindStartValues("pinhole-radtan", kImage, views, known);
  ASSERT_TRUE(start);
  EXPECT_EQ(start->state.model.parameters()(2), 300.0);
  EXPECT_EQ(start->state.model.parameters()(4), 0.01);
}

TEST(StartValues, LeaveOutAViewWithoutAPose) {
  Rng rng(9);
  auto views = SyntheticViews(Lens(585.0, 0.0), kImage, kBoard, 5, 0.3, rng);
  views[2].pixels.row(1).setConstant(100.0);  // All on a line: no homography.
  views[2].pixels.row(0).setLinSpaced(0.0, 600.0);
  const auto start = FindStartValues("pinhole-radtan", kImage, views);
  ASSERT_TRUE(start);
  EXPECT_EQ(start->used_views, (std::vector<size_t>{0, 1, 3, 4}));
}

TEST(StartValues, AreNothingWithoutViews) {
  EXPECT_FALSE(FindStartValues("pinhole-radtan", kImage, {}));
}

}  // namespace
}  // namespace calibrato
