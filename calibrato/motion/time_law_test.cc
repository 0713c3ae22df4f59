#include "calibrato/motion/time_law.h"

#include <gtest/gtest.h>

#include <numbers>

namespace calibrato {
namespace {

TEST(QuinticPhase, RestsAtBothEndsAndBeyondThem) {
  for (const double t : {-1.0, 0.0}) {
    const Phase phase = QuinticPhaseAt(t, 5.0);
    EXPECT_EQ(phase.theta, 0.0);
    EXPECT_EQ(phase.first, 0.0);
    EXPECT_EQ(phase.second, 0.0);
  }
  for (const double t : {5.0, 7.0}) {
    const Phase phase = QuinticPhaseAt(t, 5.0);
    EXPECT_NEAR(phase.theta, 2.0 * std::numbers::pi, 1e-14);
    EXPECT_EQ(phase.first, 0.0);
    EXPECT_EQ(phase.second, 0.0);
  }
}

TEST(QuinticPhase, IsHalfwayAtHalfTimeWithItsPeakSpeed) {
  // d theta / dt = 2 pi 30 s^2 (1 - s)^2 / T = 2 pi 1.875 / T at s = 1/2.
  const Phase phase = QuinticPhaseAt(2.5, 5.0);
  EXPECT_NEAR(phase.theta, std::numbers::pi, 1e-14);
  EXPECT_NEAR(phase.first, 2.0 * std::numbers::pi * 0.375, 1e-14);
  EXPECT_NEAR(phase.second, 0.0, 1e-14);
}

TEST(QuinticPhase, DerivativesAgreeWithDifferences) {
  const double step = 1e-5;
  for (const double t : {0.2, 1.1, 2.9}) {
    const Phase before = QuinticPhaseAt(t - step, 3.0);
    const Phase after = QuinticPhaseAt(t + step, 3.0);
    const Phase here = QuinticPhaseAt(t, 3.0);
    EXPECT_NEAR(here.first, (after.theta - before.theta) / (2.0 * step), 1e-8);
    EXPECT_NEAR(here.second, (after.first - before.first) / (2.0 * step), 1e-8);
    EXPECT_NEAR(here.third, (after.second - before.second) / (2.0 * step), 1e-8);
  }
}

}  // namespace
}  // namespace calibrato
