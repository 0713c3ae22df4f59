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

// Six segments: three control points at rest, three that rise, three at rest.
TimeLaw Spline() {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return {3.0, {0.0, 0.0, 0.0, 0.2 * kTurn, 0.4 * kTurn, 0.9 * kTurn, kTurn, kTurn, kTurn}};
}

TEST(PhaseAt, OfASplineRestsAtBothEndsAndNeverTurnsBack) {
  const TimeLaw law = Spline();
  for (const double t_s : {-1.0, 0.0, 3.0, 4.0}) {
    const Phase phase = PhaseAt(law, t_s);
    EXPECT_NEAR(phase.theta, t_s <= 0.0 ? 0.0 : 2.0 * std::numbers::pi, 1e-12);
    EXPECT_NEAR(phase.first, 0.0, 1e-12);
    EXPECT_NEAR(phase.second, 0.0, 1e-12);
    if (t_s < 0.0 || t_s > 3.0) {
      EXPECT_EQ(phase.third, 0.0);
    }
  }
  for (double t_s = 0.01; t_s < 3.0; t_s += 0.01) EXPECT_GT(PhaseAt(law, t_s).first, 0.0);
}

TEST(PhaseAt, OfASplineHasItsDerivatives) {
  const TimeLaw law = Spline();
  constexpr double kStep = 1e-5;
  for (double t_s = 0.123; t_s < 3.0; t_s += 0.1) {
    const Phase before = PhaseAt(law, t_s - kStep);
    const Phase here = PhaseAt(law, t_s);
    const Phase after = PhaseAt(law, t_s + kStep);
    EXPECT_NEAR((after.theta - before.theta) / (2.0 * kStep), here.first, 1e-8);
    EXPECT_NEAR((after.first - before.first) / (2.0 * kStep), here.second, 1e-8);
    EXPECT_NEAR((after.second - before.second) / (2.0 * kStep), here.third, 1e-6);
  }
}

TEST(TimeOfPhase, IsTheInverseOfTheLaw) {
  for (const TimeLaw& law : {Spline(), TimeLaw{5.0, {}}}) {
    for (const double t_s : {0.5, 1.1, 2.4}) {
      EXPECT_NEAR(TimeOfPhase(law, PhaseAt(law, t_s).theta), t_s, 1e-9);
    }
  }
}

}  // namespace
}  // namespace calibrato
