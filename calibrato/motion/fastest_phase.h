#pragma once

#include <optional>
#include <vector>

namespace calibrato {

// Time-optimal motion along a given path, by reachability analysis (TOPP-RA): H. Pham, Q.-C. Pham,
// "A new approach to time-optimal path parameterization based on reachability analysis", IEEE
// Transactions on Robotics 34(3), 2018.
//
// Velocity, acceleration and torque along a path q(theta) depend on the phase's speed and
// acceleration alone. With x the squared speed [rad^2/s^2] and u the acceleration [rad/s^2] of the
// phase, most limits are linear:
//
//     d2q/dt2 = q' u + q'' x.

/// What a limit says at one phase: by_acceleration * u + by_squared_speed * x <= bound.
struct PhaseLimit {
  double by_acceleration;
  double by_squared_speed;
  double bound;  ///< >= 0: rest is allowed.
};

/// All limits at one phase.
struct PhaseLimits {
  double max_squared_speed;  ///< Of x, >= 0, finite.
  std::vector<PhaseLimit> rows;
};

/// The largest x at every point of a grid of phases, from rest to rest: between points u is
/// constant and x linear, and the rows of both its ends hold in every interval.
///
/// Backwards, the largest x at each point from which the next one's can be met; forwards from rest,
/// the largest u that leads there. Linear in points and rows.
/// @param limits  At each point, 2 or more.
/// @param spacing  Of the points [rad], > 0.
/// @return  Nothing if some row forbids rest, or is not a number.
[[nodiscard]] std::optional<std::vector<double>> FastestSquaredSpeeds(
    const std::vector<PhaseLimits>& limits, double spacing);

}  // namespace calibrato
