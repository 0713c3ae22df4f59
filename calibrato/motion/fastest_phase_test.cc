#include "calibrato/motion/fastest_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace calibrato {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kNumIntervals = 400;
constexpr double kSpacing = kTurn / kNumIntervals;
constexpr double kFast = 1e6;  // no limit

std::vector<double> Fastest(const std::function<PhaseLimits(double)>& limits_at) {
  std::vector<PhaseLimits> limits;
  for (int i = 0; i <= kNumIntervals; ++i) limits.push_back(limits_at(kSpacing * i));
  return FastestSquaredSpeeds(limits, kSpacing).value();
}

double Duration(const std::vector<double>& x) {
  double duration_s = 0.0;
  for (size_t i = 0; i + 1 < x.size(); ++i) {
    duration_s += 2.0 * kSpacing / (std::sqrt(x[i]) + std::sqrt(x[i + 1]));
  }
  return duration_s;
}

// |first u + second x| <= bound.
void AddBothSides(double first, double second, double bound, PhaseLimits* limits) {
  limits->rows.push_back({first, second, bound});
  limits->rows.push_back({-first, -second, bound});
}

TEST(FastestSquaredSpeeds, OfOneJointWithinItsAccelerationIsBangBang) {
  // q = 0.3 theta, at most 2 rad/s^2: half the way up, half the way down, T = 2 sqrt(D / A).
  const std::vector<double> x = Fastest([](double) {
    PhaseLimits limits{kFast, {}};
    AddBothSides(0.3, 0.0, 2.0, &limits);
    return limits;
  });
  for (int i = 0; i <= kNumIntervals; ++i) {
    const double way = kSpacing * std::min(i, kNumIntervals - i);
    EXPECT_NEAR(x[static_cast<size_t>(i)], 2.0 * (2.0 / 0.3) * way, 1e-9);
  }
  EXPECT_NEAR(Duration(x), 2.0 * std::sqrt(0.3 * kTurn / 2.0), 1e-9);
}

TEST(FastestSquaredSpeeds, OfOneJointWithinItsVelocityIsATrapezoid) {
  // At most 1 rad/s: T = D / V + V / A.
  const std::vector<double> x = Fastest([](double) {
    PhaseLimits limits{1.0 / (0.3 * 0.3), {}};
    AddBothSides(0.3, 0.0, 2.0, &limits);
    return limits;
  });
  EXPECT_NEAR(*std::ranges::max_element(x), 1.0 / (0.3 * 0.3), 1e-9);
  EXPECT_NEAR(Duration(x), 0.3 * kTurn / 1.0 + 1.0 / 2.0, 1e-3);
}

TEST(FastestSquaredSpeeds, OfAStraightJointLineAreThoseOfItsMostBoundJoint) {
  // A_j / |d_j| = 4, 2.5, 10.
  const std::vector<double> x = Fastest([](double) {
    PhaseLimits limits{kFast, {}};
    AddBothSides(0.5, 0.0, 2.0, &limits);
    AddBothSides(-0.4, 0.0, 1.0, &limits);
    AddBothSides(0.1, 0.0, 1.0, &limits);
    return limits;
  });
  EXPECT_NEAR(Duration(x), 2.0 * std::sqrt(kTurn / 2.5), 1e-9);
}

TEST(FastestSquaredSpeeds, OnACircleReachTheRootOfAccelerationTimesRadius) {
  // |q'' x + q' u| <= A for q on a circle of radius r: in the middle r theta' = sqrt(A r), all of
  // the acceleration to the centre. The norm by the sides of a polygon around the circle.
  constexpr double kRadius = 0.2;
  constexpr double kBound = 1.5;
  const std::vector<double> x = Fastest([](double theta) {
    PhaseLimits limits{kFast, {}};
    for (int k = 0; k < 64; ++k) {
      const double angle = kTurn * k / 64;
      const double along = -std::sin(theta) * std::cos(angle) + std::cos(theta) * std::sin(angle);
      const double outward = std::cos(theta) * std::cos(angle) + std::sin(theta) * std::sin(angle);
      limits.rows.push_back({kRadius * along, -kRadius * outward, kBound});
    }
    return limits;
  });
  const double squared_speed = kRadius * kRadius * x[kNumIntervals / 2];
  EXPECT_NEAR(std::sqrt(squared_speed), std::sqrt(kBound * kRadius), 3e-3);
  // From rest, at a full circle: u^2 + x^2 = (A / r)^2 and u = x' / 2, so x = A / r sin(2 theta).
  for (const int i : {10, 20, 30, 40}) {
    EXPECT_NEAR(x[static_cast<size_t>(i)], kBound / kRadius * std::sin(2.0 * kSpacing * i), 0.05);
  }
}

TEST(FastestSquaredSpeeds, OnACircleOfTwoJointsNeverPassTheLimitOfEither) {
  // Where a joint turns back, only r x <= A counts.
  constexpr double kRadius = 0.2;
  const std::vector<double> x = Fastest([](double theta) {
    PhaseLimits limits{kFast, {}};
    AddBothSides(-kRadius * std::sin(theta), -kRadius * std::cos(theta), 1.5, &limits);
    AddBothSides(kRadius * std::cos(theta), -kRadius * std::sin(theta), 1.5, &limits);
    return limits;
  });
  for (const size_t i : {100, 200, 300}) {
    EXPECT_LE(x[i], 1.5 / kRadius + 1e-9);
    EXPECT_GT(x[i], 0.97 * 1.5 / kRadius);
  }
}

TEST(FastestSquaredSpeeds, OfAPendulumFollowItsEnergy) {
  // Torque I u + G sin(theta) <= L: the work of the motor less that against gravity,
  // I x / 2 = L theta - G (1 - cos theta), until it must brake.
  constexpr double kInertia = 0.5;
  constexpr double kGravity = 3.0;
  constexpr double kTorque = 5.0;
  const std::vector<double> x = Fastest([](double theta) {
    PhaseLimits limits{kFast, {}};
    const double holding = kGravity * std::sin(theta);
    limits.rows.push_back({kInertia, 0.0, kTorque - holding});
    limits.rows.push_back({-kInertia, 0.0, kTorque + holding});
    return limits;
  });
  for (const int i : {10, 100, 190}) {
    const double theta = kSpacing * i;
    const double work = kTorque * theta - kGravity * (1.0 - std::cos(theta));
    EXPECT_NEAR(x[static_cast<size_t>(i)], 2.0 * work / kInertia, 0.01 * 2.0 * work / kInertia);
  }
  // It brakes as it speeds up, the other way round.
  for (const size_t i : {10u, 100u, 190u}) EXPECT_NEAR(x[i], x[kNumIntervals - i], 1e-9);
}

TEST(FastestSquaredSpeeds, AreNoneWhereRestIsForbidden) {
  std::vector<PhaseLimits> limits(3, PhaseLimits{kFast, {{1.0, 0.0, 1.0}, {-1.0, 0.0, 1.0}}});
  EXPECT_TRUE(FastestSquaredSpeeds(limits, kSpacing).has_value());
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    limits[1].rows[0].bound = bad;
    EXPECT_FALSE(FastestSquaredSpeeds(limits, kSpacing).has_value());
  }
}

}  // namespace
}  // namespace calibrato
