#include "calibrato/motion/fastest_phase.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace calibrato {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A bound on u that changes with x: at + slope * x.
struct Line {
  double at = 0.0;
  double slope = 0.0;
  [[nodiscard]] double At(double x) const { return at + slope * x; }
};

// All that holds for u and x from one point of the grid to the next.
struct Interval {
  double max_squared_speed = kInfinity;
  std::vector<Line> upper;  // on u
  std::vector<Line> lower;

  void Add(const PhaseLimit& row) {
    // What can't be told from zero bounds x alone.
    constexpr double kTiny = 1e-12;
    if (std::abs(row.by_acceleration) <= kTiny) {
      if (row.by_squared_speed > 0.0) {
        max_squared_speed = std::min(max_squared_speed, row.bound / row.by_squared_speed);
      }
      return;
    }
    (row.by_acceleration > 0.0 ? upper : lower)
        .push_back({row.bound / row.by_acceleration, -row.by_squared_speed / row.by_acceleration});
  }

  [[nodiscard]] Line LeastUpper(double x) const {
    return *std::ranges::min_element(upper, {}, [x](const Line& line) { return line.At(x); });
  }
  [[nodiscard]] Line GreatestLower(double x) const {
    return *std::ranges::max_element(lower, {}, [x](const Line& line) { return line.At(x); });
  }

  // The largest x that leaves room for some u. The room is concave in x: Newton's method from the
  // right ends after finitely many steps, at the crossing of two lines.
  [[nodiscard]] double LargestSquaredSpeed() const {
    double x = max_squared_speed;
    constexpr int kMaxSteps = 100;
    for (int i = 0; i < kMaxSteps; ++i) {
      const Line top = LeastUpper(x);
      const Line bottom = GreatestLower(x);
      const double room = top.At(x) - bottom.At(x);
      const double slope = top.slope - bottom.slope;
      if (room >= 0.0 || !(slope < 0.0)) break;
      const double crossing = (bottom.at - top.at) / slope;
      if (!(crossing < x)) break;
      x = std::max(crossing, 0.0);
    }
    return x;
  }
};

Interval Between(const PhaseLimits& here, const PhaseLimits& there, double spacing,
                 double max_squared_speed_there) {
  Interval interval;
  interval.max_squared_speed = here.max_squared_speed;
  interval.upper.reserve(here.rows.size() + there.rows.size() + 1);
  interval.lower.reserve(here.rows.size() + there.rows.size() + 1);
  for (const PhaseLimit& row : here.rows) interval.Add(row);
  // Over there the squared speed is x + 2 spacing u.
  for (const PhaseLimit& row : there.rows) {
    interval.Add({row.by_acceleration + 2.0 * spacing * row.by_squared_speed, row.by_squared_speed,
                  row.bound});
  }
  interval.Add({2.0 * spacing, 1.0, max_squared_speed_there});
  interval.Add({-2.0 * spacing, -1.0, 0.0});
  return interval;
}

bool AllowsRest(const PhaseLimits& limits) {
  return limits.max_squared_speed >= 0.0 &&
         std::ranges::all_of(limits.rows, [](const PhaseLimit& row) {
           return row.bound >= 0.0 && std::isfinite(row.by_acceleration) &&
                  std::isfinite(row.by_squared_speed);
         });
}

}  // namespace

std::optional<std::vector<double>> FastestSquaredSpeeds(const std::vector<PhaseLimits>& limits,
                                                        double spacing) {
  assert(limits.size() >= 2 && spacing > 0.0);
  if (!std::ranges::all_of(limits, AllowsRest)) return std::nullopt;
  const size_t last = limits.size() - 1;
  std::vector<double> x(limits.size(), 0.0);
  std::vector<Interval> intervals(last);
  for (size_t i = last; i-- > 0;) {
    intervals[i] = Between(limits[i], limits[i + 1], spacing, x[i + 1]);
    x[i] = intervals[i].LargestSquaredSpeed();
  }
  x[0] = 0.0;
  for (size_t i = 0; i < last; ++i) {
    const double u = intervals[i].LeastUpper(x[i]).At(x[i]);
    x[i + 1] = std::clamp(x[i] + 2.0 * spacing * u, 0.0, x[i + 1]);
  }
  return x;
}

}  // namespace calibrato
