#include "calibrato/motion/joint_timing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "calibrato/motion/joint_motion.h"
#include "calibrato/motion/panda_dynamics.h"
#include "calibrato/motion/time_law.h"

namespace calibrato {
namespace {

// Joint `joint` moves as amplitude * sin(theta).
JointPath SinePath(int joint, double amplitude) {
  JointPath path;
  path.start = JointVector::Zero();
  JointPath::Loop& loop = path.loops.emplace_back();
  for (int i = 1; i < kNumWayPoints; ++i) {
    loop[i - 1] = amplitude * std::sin(WayPointPhase(i)) * JointVector::Unit(joint);
  }
  return path;
}

TEST(SmallestStretch, IsOneForASlowLoop) {
  EXPECT_EQ(SmallestStretch(SinePath(2, 0.01), 0, {5.0, {}}), 1.0);
}

TEST(SmallestStretch, MeetsTheLimitsOfAKnownPathExactly) {
  // Velocity amplitude cos(theta) theta', acceleration amplitude (cos(theta) theta'' - sin(theta)
  // theta'^2), in closed form at many instants.
  for (const int joint : {0, 1, 6}) {
    const double amplitude = 1.2;
    double expected = 1.0;
    for (int k = 0; k <= 20000; ++k) {
      const Phase phase = QuinticPhaseAt(2.0 * k / 20000.0, 2.0);
      const double velocity = amplitude * std::cos(phase.theta) * phase.first;
      const double acceleration = amplitude * (std::cos(phase.theta) * phase.second -
                                               std::sin(phase.theta) * phase.first * phase.first);
      expected = std::max({expected, std::abs(velocity) / Limits().velocity[joint],
                           std::sqrt(std::abs(acceleration) / Limits().acceleration[joint])});
    }
    EXPECT_GT(expected, 1.0);
    EXPECT_NEAR(SmallestStretch(SinePath(joint, amplitude), 0, {2.0, {}}), expected,
                2e-3 * expected);
  }
}

// Of a path that swings joint `joint` by `amplitude`, with one limit lowered to what the motion
// needs at `slower` times its duration: limits hold at that stretch and no earlier.
TEST(SmallestStretch, IsOneWhereALimitIsJustMetAndMoreBeyondIt) {
  const JointPath path = SinePath(1, 0.3);
  const LoopJointSpline spline(path, 0);
  const double duration_s = 5.0;
  ASSERT_EQ(SmallestStretch(path, 0, {duration_s, {}}), 1.0);
  const double stretch = 1.3;
  PandaLimits jerk = Limits();
  PandaLimits torque = Limits();
  jerk.jerk[1] = torque.torque[1] = 0.0;
  constexpr int kNumInstants = 50'000;
  for (int k = 0; k <= kNumInstants; ++k) {
    const JointMotion joints =
        spline.At(QuinticPhaseAt(stretch * duration_s * k / kNumInstants, stretch * duration_s));
    jerk.jerk[1] = std::max(jerk.jerk[1], std::abs(joints.jerk[1]));
    torque.torque[1] =
        std::max(torque.torque[1],
                 std::abs(PandaTorque(joints.position, joints.velocity, joints.acceleration)[1]));
  }
  // But for what lies between the instants of either side.
  EXPECT_NEAR(SmallestStretch(path, 0, {duration_s, {}}, jerk), stretch, 1e-5);
  EXPECT_NEAR(SmallestStretch(path, 0, {duration_s, {}}, torque), stretch, 1e-5);
  EXPECT_NEAR(SmallestStretch(path, 0, {stretch * duration_s, {}}, torque), 1.0, 1e-5);
}

TEST(SmallestStretch, IsInfiniteWhereTheArmCannotHoldItself) {
  PandaLimits weak = Limits();
  weak.torque[1] = 0.0;
  EXPECT_EQ(SmallestStretch(SinePath(1, 0.3), 0, {5.0, {}}, weak),
            std::numeric_limits<double>::infinity());
}

TEST(TimedJointPath, PassesEachWayPointAtItsPhase) {
  JointPath path = SinePath(3, 0.1);
  path.loops.push_back(path.loops[0]);
  const std::vector<JointSample> samples = TimedJointPath(path, {{5.0, {}}, {8.0, {}}});
  ASSERT_EQ(samples.size(), 124u);
  for (int i = 1; i <= 62; ++i) {
    EXPECT_NEAR(QuinticPhaseAt(samples[i - 1].t_s, 5.0).theta, WayPointPhase(i), 1e-9);
    EXPECT_NEAR(QuinticPhaseAt(samples[i + 61].t_s - 5.0, 8.0).theta, WayPointPhase(i), 1e-9);
  }
  EXPECT_EQ(samples[61].t_s, 5.0);
  EXPECT_EQ(samples[123].t_s, 13.0);
  EXPECT_EQ(samples[61].position, path.start);
}

}  // namespace
}  // namespace calibrato
