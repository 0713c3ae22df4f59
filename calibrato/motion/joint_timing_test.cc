#include "calibrato/motion/joint_timing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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
  EXPECT_EQ(SmallestStretch(SinePath(2, 0.01), 0, 5.0), 1.0);
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
    EXPECT_NEAR(SmallestStretch(SinePath(joint, amplitude), 0, 2.0), expected, 2e-3 * expected);
  }
}

TEST(TimedJointPath, PassesEachWayPointAtItsPhase) {
  JointPath path = SinePath(3, 0.1);
  path.loops.push_back(path.loops[0]);
  const std::vector<JointSample> samples = TimedJointPath(path, {5.0, 8.0});
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
