#include "calibrato/guide/gesture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "calibrato/calibration/planned_frame.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

GestureSetting Setting() {
  const Board board = Checkerboard{6, 7, 0.06, 0.06};
  GestureSetting setting{CameraModel("pinhole-none", Eigen::Vector4d(585.0, 585.0, 320.0, 240.0)),
                         {640, 480},
                         PlannedView(board),
                         {},
                         {}};
  // Before the board, z towards it, a little off its middle.
  Rigid3 T_g_c;
  T_g_c.R = ExpSo3(Vector3d(0.1, -0.05, 0.0)) * Vector3d(1.0, -1.0, -1.0).asDiagonal();
  T_g_c.t = Vector3d(0.2, 0.1, 1.3);
  setting.T_g_c = FacingBoard(setting.points, T_g_c);
  return setting;
}

TEST(FacingBoard, HasTheBoardsMiddleInTheImagesMiddle) {
  const GestureSetting setting = Setting();
  const Vector3d seen = setting.T_g_c.Inverse() * BoardCentre(Checkerboard{6, 7, 0.06, 0.06});
  EXPECT_NEAR(seen.x(), 0.0, 1e-12);
  EXPECT_NEAR(seen.y(), 0.0, 1e-12);
  EXPECT_GT(seen.z(), 1.0);
}

TEST(GesturesFor, KeepTheBoardInViewAndTheHandWithinItsLimits) {
  const GestureSetting setting = Setting();
  const std::vector<Gesture> gestures = GesturesFor(setting);
  EXPECT_GE(gestures.size(), 14U);
  for (const Gesture& gesture : gestures) {
    constexpr double kStep = 1e-3;
    for (double t = kStep; t < gesture.duration_s - kStep; t += 0.02) {
      const Rigid3 before = PoseAt(gesture, t - kStep);
      const Rigid3 now = PoseAt(gesture, t);
      const Rigid3 after = PoseAt(gesture, t + kStep);
      EXPECT_GT(MarginInImage(setting.camera, setting.resolution, setting.points, now.Inverse()),
                5.0)
          << gesture.name << " at " << t;
      const double speed = (after.t - before.t).norm() / (2.0 * kStep);
      const double rate = LogSo3(before.R.transpose() * after.R).norm() / (2.0 * kStep);
      // Where the window rises it adds to the speed of what it opens.
      EXPECT_LT(speed, 1.6 * setting.hand.speed) << gesture.name << " at " << t;
      EXPECT_LT(rate, 1.6 * setting.hand.angular_speed) << gesture.name << " at " << t;
      EXPECT_LT((now.t - setting.T_g_c.t).norm(), setting.hand.reach_m + 1e-9) << gesture.name;
    }
  }
}

TEST(GesturesFor, BeginAndEndAtRestInTheirMiddle) {
  for (const Gesture& gesture : GesturesFor(Setting())) {
    for (const double t : {0.0, gesture.duration_s}) {
      const Rigid3 end = PoseAt(gesture, t);
      EXPECT_NEAR((end.R - gesture.T_g_c.R).norm() + (end.t - gesture.T_g_c.t).norm(), 0.0, 1e-12);
      const Rigid3 near = PoseAt(gesture, std::abs(t - 1e-3));
      EXPECT_LT((near.R - end.R).norm() + (near.t - end.t).norm(), 1e-5) << gesture.name;
    }
  }
}

// A camera that turns about its y axis (down) by a positive angle looks further right: the board
// moves to the left of the image.
TEST(GesturesFor, CornersAreWhereTheirWordsSay) {
  const GestureSetting setting = Setting();
  int num_found = 0;
  for (const Gesture& gesture : GesturesFor(setting)) {
    if (gesture.name.rfind("board at the ", 0) != 0) continue;
    ++num_found;
    const auto middle = setting.camera.Project(gesture.T_g_c.Inverse() *
                                               BoardCentre(Checkerboard{6, 7, 0.06, 0.06}));
    ASSERT_TRUE(middle);
    const bool is_left = gesture.name.find("left") != std::string::npos;
    const bool is_top = gesture.name.find("top") != std::string::npos;
    EXPECT_EQ(middle->x() < 320.0, is_left) << gesture.name;
    EXPECT_EQ(middle->y() < 240.0, is_top) << gesture.name;
  }
  EXPECT_EQ(num_found, 4);
}

}  // namespace
}  // namespace calibrato
