#include "calibrato/guide/motion_gestures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibrato/base/rng.h"
#include "calibrato/calibration/planned_frame.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

GestureSetting Setting() {
  const Rig rig = PaperRig();
  GestureSetting setting{
      rig.cameras.front().model, rig.cameras.front().resolution, PlannedView(rig.board), {}, {}};
  Rigid3 T_g_c;
  T_g_c.R = Vector3d(1.0, -1.0, -1.0).asDiagonal();
  T_g_c.t = Vector3d(0.15, 0.18, 1.4);
  setting.T_g_c = FacingBoard(setting.points, T_g_c);
  return setting;
}

// A sweep along x of the base, there and back: (cos theta - 1) times the coefficient.
Motion Sweep(double amplitude_m) {
  Motion motion;
  motion.loops.resize(1);
  const Eigen::Index along_x = 0;
  motion.loops[0].coefficients(along_x) = amplitude_m;
  motion.loops[0].duration_s = 5.0;
  return motion;
}

TEST(CameraLoop, IsClosedAndAsLongAsThatOfTheFrameThatCarriesIt) {
  const CameraLoop loop{{}, Sweep(0.1).loops[0].coefficients, PaperRig().T_e_c0};
  for (const double theta : {0.0, 2.0 * std::numbers::pi}) {
    const Rigid3 end = PoseAt(loop, theta);
    EXPECT_NEAR((end.R - Eigen::Matrix3d::Identity()).norm() + end.t.norm(), 0.0, 1e-12);
  }
  // Without turns the camera is as far away as the frame, whichever way it looks.
  EXPECT_NEAR(PoseAt(loop, std::numbers::pi).t.norm(), 0.2, 1e-12);
}

TEST(GesturesOfMotion, KeepTheBoardInViewAndTheHandWithinItsLimits) {
  const GestureSetting setting = Setting();
  Rng rng(5);
  for (const Motion& motion : {HandcraftedMotion(Task::kIntrinsic), RandomMotion(Task::kJoint, rng),
                               HandcraftedMotion(Task::kExtrinsic)}) {
    const std::vector<Gesture> gestures = GesturesOfMotion(setting, motion);
    ASSERT_FALSE(gestures.empty());
    for (const Gesture& gesture : gestures) {
      constexpr double kStep = 1e-3;
      for (double t = kStep; t < gesture.duration_s - kStep; t += 0.02) {
        const Rigid3 before = PoseAt(gesture, t - kStep);
        const Rigid3 now = PoseAt(gesture, t);
        const Rigid3 after = PoseAt(gesture, t + kStep);
        EXPECT_GT(MarginInImage(setting.camera, setting.resolution, setting.points, now.Inverse()),
                  5.0)
            << gesture.name << " at " << t;
        EXPECT_LT((after.t - before.t).norm() / (2.0 * kStep), 1.05 * setting.hand.speed);
        EXPECT_LT((after.t - 2.0 * now.t + before.t).norm() / (kStep * kStep),
                  1.05 * setting.hand.acceleration);
        EXPECT_LT(LogSo3(before.R.transpose() * after.R).norm() / (2.0 * kStep),
                  1.05 * setting.hand.angular_speed);
        EXPECT_LT((now.t - setting.T_g_c.t).norm(), setting.hand.reach_m + 1e-3);
      }
      const Rigid3 end = PoseAt(gesture, gesture.duration_s);
      EXPECT_LT((end.t - setting.T_g_c.t).norm(), 1e-9);
    }
  }
}

// What fits is left as it was, but for its time.
TEST(GesturesOfMotion, LeaveAMotionThatFitsItsSize) {
  const GestureSetting setting = Setting();
  const auto farthest = [&](double amplitude_m) {
    const auto gestures = GesturesOfMotion(setting, Sweep(amplitude_m));
    double way = 0.0;
    for (const Gesture& gesture : gestures) {
      way = (PoseAt(gesture, 0.5 * gesture.duration_s).t - setting.T_g_c.t).norm();
    }
    return way;
  };
  EXPECT_NEAR(farthest(0.02), 0.04, 1e-9);
  // Twice the amplitude, down to the reach.
  EXPECT_LE(farthest(0.2), setting.hand.reach_m);
  EXPECT_GT(farthest(0.2), 0.5 * setting.hand.reach_m);
  // A fifth of this is beyond it.
  EXPECT_EQ(farthest(2.0), 0.0);
  // Nothing to follow.
  EXPECT_TRUE(GesturesOfMotion(setting, Sweep(0.0)).empty());
}

}  // namespace
}  // namespace calibrato
