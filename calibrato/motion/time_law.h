#pragma once

namespace calibrato {

/// How the phase of a loop runs with time: theta(s) = 2 pi (10 s^3 - 15 s^4 + 6 s^5), s = t /
/// duration in [0, 1], at rest at both ends. Outside, it stays at its ends.
struct Phase {
  double theta;   ///< [rad]
  double first;   ///< d theta / dt [rad/s]
  double second;  ///< d2 theta / dt2 [rad/s^2]
  double third;   ///< d3 theta / dt3 [rad/s^3]; jumps at both ends.
};
[[nodiscard]] Phase QuinticPhaseAt(double t_s, double duration_s);

}  // namespace calibrato
