#include "calibrato/motion/free_carrier.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "calibrato/motion/board_in_view.h"
#include "calibrato/motion/loop_state.h"
#include "calibrato/motion/optimal_timing.h"
#include "calibrato/motion/stretch.h"
#include "calibrato/motion/way_point.h"

namespace calibrato {
namespace {

std::optional<Refusal> CheckPose(const Rigid3& T_b_e, const Rig& rig,
                                 const FreeCarrierLimits& limits) {
  Refusal refusal;
  refusal.unit = "m";
  const double reach = (T_b_e.t - FreeCarrierShoulder()).norm();
  if (!(reach <= limits.reach)) {
    refusal.limit = "reach from the shoulder";
    refusal.value = reach;
    refusal.bound = limits.reach;
    return refusal;
  }
  if (!(T_b_e.t.z() >= limits.min_height)) {
    refusal.limit = "height above the arm's base";
    refusal.value = T_b_e.t.z();
    refusal.bound = limits.min_height;
    return refusal;
  }
  return CheckBoardInView(T_b_e, rig);
}

double SmallestStretch(const BasePose& base, const LoopCoefficients& coefficients,
                       const TimeLaw& law, const FreeCarrierLimits& limits) {
  return LargestDuring(law, {}, 1.0, [&](double t_s) {
    const CarrierState state = LoopStateAt(base, coefficients, PhaseAt(law, t_s));
    // Stretched by c, velocities fall as 1 / c and accelerations as 1 / c^2.
    return std::max({state.velocity_b.norm() / limits.speed,
                     state.angular_velocity_b.norm() / limits.angular_speed,
                     std::sqrt(state.acceleration_b.norm() / limits.acceleration),
                     std::sqrt(state.angular_acceleration_b.norm() / limits.angular_acceleration)});
  });
}

// |first u + second x| <= bound in the plane of the two vectors, by the sides of a polygon within
// the circle.
void AddNormLimit(const Eigen::Vector3d& first, const Eigen::Vector3d& second, double bound,
                  std::vector<PhaseLimit>* rows) {
  constexpr int kNumSides = 24;
  const Eigen::Vector3d along = first.stableNormalized();
  const Eigen::Vector3d across = (second - along.dot(second) * along).stableNormalized();
  for (int k = 0; k < kNumSides; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kNumSides;
    const Eigen::Vector3d side = std::cos(angle) * along + std::sin(angle) * across;
    rows->push_back(
        {side.dot(first), side.dot(second), bound * std::cos(std::numbers::pi / kNumSides)});
  }
}

PhaseLimits PhaseLimitsOfFrame(const BasePose& base, const LoopCoefficients& coefficients,
                               double theta, const FreeCarrierLimits& limits) {
  const CarrierState by_phase =
      LoopStateAt(base, coefficients, {.theta = theta, .first = 1.0, .second = 0.0, .third = 0.0});
  PhaseLimits at_phase;
  const double max_speed =
      1.0 / std::max(by_phase.velocity_b.norm() / limits.speed,
                     by_phase.angular_velocity_b.norm() / limits.angular_speed);
  at_phase.max_squared_speed = max_speed * max_speed;
  AddNormLimit(by_phase.velocity_b, by_phase.acceleration_b, limits.acceleration, &at_phase.rows);
  AddNormLimit(by_phase.angular_velocity_b, by_phase.angular_acceleration_b,
               limits.angular_acceleration, &at_phase.rows);
  return at_phase;
}

TimeLaw Timed(const BasePose& base, const Loop& loop, Timing timing,
              const FreeCarrierLimits& limits) {
  const auto stretch = [&](const TimeLaw& law) {
    return SmallestStretch(base, loop.coefficients, law, limits);
  };
  if (timing == Timing::kOptimal) {
    return FastestTimeLaw(
        [&](double theta) { return PhaseLimitsOfFrame(base, loop.coefficients, theta, limits); },
        stretch);
  }
  TimeLaw law{loop.duration_s, {}};
  law.duration_s *= stretch(law);
  return law;
}

}  // namespace

Eigen::Vector3d FreeCarrierShoulder() { return {0.0, 0.0, 0.333}; }

std::variant<TimedMotion, Refusal> PlanOnFreeCarrier(const Motion& motion, const Rig& rig) {
  const FreeCarrierLimits limits;
  std::optional<Refusal> first_refusal;
  int num_bad_way_points = 0;
  for (size_t i = 0; i < motion.loops.size(); ++i) {
    for (int way_point = 1; way_point <= kNumWayPoints; ++way_point) {
      const Rigid3 T_b_e =
          LoopPoseAt(motion.base_pose, motion.loops[i].coefficients, WayPointPhase(way_point));
      std::optional<Refusal> refusal = CheckPose(T_b_e, rig, limits);
      if (!refusal) continue;
      ++num_bad_way_points;
      if (first_refusal) continue;
      refusal->loop = static_cast<int>(i);
      refusal->way_point = way_point;
      first_refusal = refusal;
    }
  }
  if (first_refusal) {
    first_refusal->num_bad_way_points = num_bad_way_points;
    first_refusal->num_way_points = kNumWayPoints * static_cast<int>(motion.loops.size());
    return *first_refusal;
  }
  std::vector<TimeLaw> laws;
  for (const Loop& loop : motion.loops) {
    laws.push_back(Timed(motion.base_pose, loop, motion.timing, limits));
  }
  TimedMotion timed;
  timed.motion = motion;
  timed.SetTimeLaws(laws);
  return timed;
}

}  // namespace calibrato
