#include "calibrato/motion/optimal_timing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

namespace calibrato {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kNumIntervals = 496;
constexpr double kSpacing = kTurn / kNumIntervals;

std::vector<PhaseLimits> LimitsOnGrid(const std::function<PhaseLimits(double theta)>& limits_at) {
  constexpr double kMaxSquaredSpeed = (kTurn / kShortestLoop) * (kTurn / kShortestLoop);
  std::vector<PhaseLimits> limits;
  limits.reserve(kNumIntervals + 1);
  for (int i = 0; i <= kNumIntervals; ++i) {
    PhaseLimits& here = limits.emplace_back(limits_at(kSpacing * i));
    here.max_squared_speed = std::min(here.max_squared_speed, kMaxSquaredSpeed);
  }
  return limits;
}

// When each point of the grid is passed [s].
std::vector<double> PassingTimes(const std::vector<double>& squared_speed) {
  std::vector<double> times = {0.0};
  for (size_t i = 0; i + 1 < squared_speed.size(); ++i) {
    times.push_back(times.back() +
                    2.0 * kSpacing /
                        (std::sqrt(squared_speed[i]) + std::sqrt(squared_speed[i + 1])));
  }
  return times;
}

// The phase at equal times, as control points.
std::vector<double> ControlPoints(const std::vector<double>& squared_speed,
                                  const std::vector<double>& times, int num_steps) {
  std::vector<double> points = {0.0, 0.0};
  size_t i = 0;
  for (int k = 0; k < num_steps; ++k) {
    const double t_s = times.back() * k / num_steps;
    while (i + 2 < times.size() && times[i + 1] < t_s) ++i;
    const double since = t_s - times[i];
    const double acceleration = (squared_speed[i + 1] - squared_speed[i]) / (2.0 * kSpacing);
    points.push_back(kSpacing * static_cast<double>(i) + std::sqrt(squared_speed[i]) * since +
                     0.5 * acceleration * since * since);
  }
  points.insert(points.end(), 3, kTurn);
  return points;
}

std::optional<TimeLaw> SmoothedFastest(std::vector<PhaseLimits> limits) {
  std::optional<std::vector<double>> speeds = FastestSquaredSpeeds(limits, kSpacing);
  if (!speeds) return std::nullopt;
  // Where the path itself turns back, only this bounds the phase's acceleration.
  constexpr double kRiseTime = 0.05;  // [s]
  const double max_acceleration = kTurn / (PassingTimes(*speeds).back() * kRiseTime);
  for (PhaseLimits& here : limits) {
    here.rows.push_back({1.0, 0.0, max_acceleration});
    here.rows.push_back({-1.0, 0.0, max_acceleration});
  }
  speeds = FastestSquaredSpeeds(limits, kSpacing);
  if (!speeds) return std::nullopt;
  const std::vector<double> times = PassingTimes(*speeds);
  if (!std::isfinite(times.back())) return std::nullopt;
  constexpr double kMaxStep = 0.01;          // [s]
  constexpr double kMaxNumSteps = 10'000.0;  // slower loops get longer steps
  const auto num_steps =
      static_cast<int>(std::clamp(std::ceil(times.back() / kMaxStep), 4.0, kMaxNumSteps));
  // Half a support of the spline before and after: one step each.
  return TimeLaw{times.back() * (num_steps + 2) / num_steps,
                 ControlPoints(*speeds, times, num_steps)};
}

}  // namespace

double LeastDuration(const std::function<PhaseLimits(double theta)>& limits_at) {
  const auto speeds = FastestSquaredSpeeds(LimitsOnGrid(limits_at), kSpacing);
  return speeds ? PassingTimes(*speeds).back() : std::numeric_limits<double>::infinity();
}

TimeLaw FastestTimeLaw(const std::function<PhaseLimits(double theta)>& limits_at,
                       const std::function<double(const TimeLaw&)>& smallest_stretch) {
  TimeLaw quintic{kShortestLoop, {}};
  quintic.duration_s *= smallest_stretch(quintic);
  std::optional<TimeLaw> fastest = SmoothedFastest(LimitsOnGrid(limits_at));
  if (!fastest) return quintic;
  fastest->duration_s *= smallest_stretch(*fastest);
  return fastest->duration_s < quintic.duration_s ? *std::move(fastest) : quintic;
}

}  // namespace calibrato
