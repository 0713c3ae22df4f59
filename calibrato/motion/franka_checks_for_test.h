#pragma once

#include <algorithm>
#include <vector>

#include "calibrato/motion/panda.h"

namespace calibrato {

/// The bounds of libfranka 0.9.2's rate limiter for the Panda, the last release that supports it:
/// the data sheet's, less 1e-3, and velocities less what three lost packets can add.
struct FrankaBounds {
  JointVector velocity;      ///< [rad/s]
  JointVector acceleration;  ///< [rad/s^2]
  JointVector jerk;          ///< [rad/s^3]
};
inline FrankaBounds BoundsOfFranka() {
  constexpr double kEps = 1e-3;
  constexpr double kThreeCycles = 3e-3;  // [s]
  FrankaBounds bounds;
  bounds.jerk << 7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0;
  bounds.acceleration << 15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0;
  bounds.velocity << 2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61;
  bounds.jerk.array() -= kEps;
  bounds.acceleration.array() -= kEps;
  bounds.velocity -= kThreeCycles * bounds.acceleration;
  bounds.velocity.array() -= kEps;
  return bounds;
}

/// The largest shares of those bounds.
struct FrankaShares {
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
};

/// Commanded positions, one a millisecond, as the arm's controller judges them: by differences,
/// standing still before the first command and after the last. Jumps of velocity are accelerations
/// to it, jumps of acceleration jerks.
inline FrankaShares JudgedByFranka(std::vector<JointVector> q) {
  q.insert(q.begin(), 3, q.front());
  q.insert(q.end(), 3, q.back());
  const FrankaBounds bounds = BoundsOfFranka();
  constexpr double kCycle = 1e-3;  // [s]
  const auto differences = [&](const std::vector<JointVector>& values) {
    std::vector<JointVector> rates;
    for (size_t k = 1; k < values.size(); ++k) {
      rates.push_back((values[k] - values[k - 1]) / kCycle);
    }
    return rates;
  };
  const auto largest = [](const std::vector<JointVector>& values, const JointVector& bound) {
    double share = 0.0;
    for (const JointVector& v : values) {
      share = std::max(share, v.cwiseAbs().cwiseQuotient(bound).maxCoeff());
    }
    return share;
  };
  const std::vector<JointVector> velocity = differences(q);
  const std::vector<JointVector> acceleration = differences(velocity);
  const std::vector<JointVector> jerk = differences(acceleration);
  return {largest(velocity, bounds.velocity), largest(acceleration, bounds.acceleration),
          largest(jerk, bounds.jerk)};
}

}  // namespace calibrato
