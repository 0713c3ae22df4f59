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
      for (const ViewInliers& view : start->views) EXPECT_EQ(view.count(), 42);
      EXPECT_NEAR(start->model.parameters()(0), f, 0.2 * f) << "k1 " << k1;
    }
  }
}

TEST(StartValues, KeepWhatIsFixed) {
  Rng rng(8);
  const auto views = SyntheticViews(Lens(585.0, 0.0), kImage, kBoard, 5, 0.3, rng);
  Eigen::VectorXd known = Eigen::VectorXd::Constant(8, std::nan(""));
  known(2) = 300.0;
  known(4) = 0.01;
  std::vector<bool> fixed(8, false);
  fixed[2] = fixed[4] = true;
  const auto start = FindStartValues("pinhole-radtan", kImage, views, known, fixed);
  ASSERT_TRUE(start);
  EXPECT_EQ(start->model.parameters()(2), 300.0);
  EXPECT_EQ(start->model.parameters()(4), 0.01);
  EXPECT_NE(start->model.parameters()(5), 0.0);
}

TEST(StartValues, LeaveOutAViewWithoutAPose) {
  Rng rng(9);
  auto views = SyntheticViews(Lens(585.0, 0.0), kImage, kBoard, 5, 0.3, rng);
  views[2].points_g.row(1).setConstant(0.1);  // All on a line: any turn about it would do.
  const auto start = FindStartValues("pinhole-radtan", kImage, views);
  ASSERT_TRUE(start);
  for (size_t v = 0; v < views.size(); ++v) EXPECT_EQ(start->views[v].count() > 0, v != 2) << v;
}

TEST(StartValues, AreNothingWithoutViews) {
  EXPECT_FALSE(FindStartValues("pinhole-radtan", kImage, {}));
}

}  // namespace
}  // namespace calibrato
