#pragma once

#include <vector>

namespace calibrato {

/// How the phase of a loop runs with time. Outside the loop it stays at its ends.
struct Phase {
  double theta;   ///< [rad]
  double first;   ///< d theta / dt [rad/s]
  double second;  ///< d2 theta / dt2 [rad/s^2]
  double third;   ///< d3 theta / dt3 [rad/s^3]; jumps at both ends.
};

/// theta(s) = 2 pi (10 s^3 - 15 s^4 + 6 s^5), s = t / duration in [0, 1], at rest at both ends.
[[nodiscard]] Phase QuinticPhaseAt(double t_s, double duration_s);

/// The time law of one loop: the quintic, or a uniform cubic B-spline by the control points of its
/// phase. Of n of them the first three are 0 and the last three 2 pi, so that the loop is at rest,
/// without acceleration, at both ends; they never fall; the spline has n - 3 segments of one
/// length. Its third derivative is constant in each.
struct TimeLaw {
  double duration_s = 5.0;             ///< > 0
  std::vector<double> control_points;  ///< [rad]; none for the quintic, else 7 or more.
};
[[nodiscard]] Phase PhaseAt(const TimeLaw& law, double t_s);
/// The same for who keeps the two apart.
[[nodiscard]] Phase PhaseAt(const std::vector<double>& control_points, double t_s,
                            double duration_s);

/// When the law passes a phase. @param theta  In [0, 2 pi] [rad].
[[nodiscard]] double TimeOfPhase(const TimeLaw& law, double theta);

}  // namespace calibrato
