#include <algorithm>
#include <cassert>
#include <cmath>

#include "calibrato/mdp/design_problem.h"
#include "calibrato/motion/loop_demands.h"

namespace calibrato {
namespace {

constexpr double kLeastFactor = 1e-3;
constexpr double kFactorTolerance = 1e-3;
constexpr double kShortestLoop = 0.5;  // Of a loop that hardly moves [s].
constexpr double kUnlimited = 1e9;

// What a loop needs at some factor.
struct Needs {
  double shortest_s = 0.0;  // For its speeds and accelerations.
  bool fits = true;         // Reach, height and view.
};

// Between the instants a demand may be larger by this share; the smooth maximum is an upper bound,
// but a poor one far below the limit.
double AtMost(const LoopDemand& demand) {
  constexpr double kBetween = 1.01;
  return std::max(0.0, std::min(demand.value, kBetween * demand.largest));
}

Needs NeedsOf(const MotionDesignProblem& problem, const Loop& loop) {
  const LoopDemands demands =
      DemandsOf(problem.base_pose, loop, problem.rigs.front(), problem.limits);
  // Speeds go with one over the duration, accelerations with one over its square.
  const double stretch = std::max({AtMost(demands.speed), AtMost(demands.angular_speed),
                                   std::sqrt(AtMost(demands.acceleration)),
                                   std::sqrt(AtMost(demands.angular_acceleration))});
  const bool fits =
      AtMost(demands.reach) <= 1.0 && AtMost(demands.depth) <= 1.0 && AtMost(demands.view) <= 1.0;
  return {std::max(kShortestLoop, stretch * loop.duration_s), fits};
}

}  // namespace

std::optional<Motion> FitToBudget(const MotionDesignProblem& problem, Motion motion) {
  assert(motion.loops.size() == static_cast<size_t>(problem.num_loops));
  motion.base_pose = problem.base_pose;
  const LoopCoefficients limit = ScaledAction(LoopCoefficients::Ones()) * problem.coefficient_limit;
  const auto first = static_cast<size_t>(problem.num_fixed_loops);
  double path_left = problem.max_path_m;
  double time_left = problem.max_duration_s;
  double path = 0.0;
  for (size_t i = 0; i < motion.loops.size(); ++i) {
    Loop& loop = motion.loops[i];
    if (i < first) {
      path_left -= PathLength(loop.coefficients);
      time_left -= loop.duration_s;
      continue;
    }
    loop.coefficients = loop.coefficients.cwiseMax(-limit).cwiseMin(limit);
    path += PathLength(loop.coefficients);
  }
  const Motion whole = motion;
  std::vector<double> shortest(motion.loops.size(), 0.0);
  // Sets the motion to the factor and tells whether it fits.
  const auto fits = [&](double factor) {
    double needed_s = 0.0;
    bool all_fit = true;
    for (size_t i = first; i < motion.loops.size(); ++i) {
      motion.loops[i].coefficients = factor * whole.loops[i].coefficients;
      const Needs needs = NeedsOf(problem, motion.loops[i]);
      shortest[i] = needs.shortest_s;
      needed_s += needs.shortest_s;
      all_fit = all_fit && needs.fits;
    }
    return all_fit && needed_s <= time_left;
  };
  // The path grows with the factor, as every offset does.
  double high = path > 0.0 ? std::min(1.0, path_left / path) : 1.0;
  if (!(high > 0.0)) return std::nullopt;
  if (!fits(high)) {
    double low = kLeastFactor * high;
    if (!fits(low)) return std::nullopt;
    while (high - low > kFactorTolerance * high) {
      const double middle = 0.5 * (low + high);
      (fits(middle) ? low : high) = middle;
    }
    if (!fits(low)) return std::nullopt;
  }
  double needed_s = 0.0;
  double beyond_s = 0.0;
  for (size_t i = first; i < motion.loops.size(); ++i) {
    needed_s += shortest[i];
    beyond_s += std::max(0.0, motion.loops[i].duration_s - shortest[i]);
  }
  const bool time_is_limited = problem.max_duration_s < kUnlimited;
  for (size_t i = first; i < motion.loops.size(); ++i) {
    double& duration_s = motion.loops[i].duration_s;
    const double beyond = std::max(0.0, duration_s - shortest[i]);
    if (!time_is_limited) {
      duration_s = shortest[i] + beyond;
    } else if (beyond_s > 0.0) {
      duration_s = shortest[i] + beyond / beyond_s * (time_left - needed_s);
    } else {
      duration_s = shortest[i] * time_left / needed_s;
    }
  }
  return motion;
}

}  // namespace calibrato
