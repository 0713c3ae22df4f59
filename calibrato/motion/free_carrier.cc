#include "calibrato/motion/free_carrier.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibrato/motion/board_in_view.h"
#include "calibrato/motion/loop_state.h"
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

double SmallestStretch(const BasePose& base, const Loop& loop, const FreeCarrierLimits& limits) {
  constexpr int kNumInstants = 500;
  double stretch = 1.0;
  for (int i = 0; i <= kNumInstants; ++i) {
    const Phase phase = QuinticPhaseAt(loop.duration_s * i / kNumInstants, loop.duration_s);
    const CarrierState state = LoopStateAt(base, loop.coefficients, phase);
    // Stretched by c, velocities fall as 1 / c and accelerations as 1 / c^2.
    stretch =
        std::max({stretch, state.velocity_b.norm() / limits.speed,
                  state.angular_velocity_b.norm() / limits.angular_speed,
                  std::sqrt(state.acceleration_b.norm() / limits.acceleration),
                  std::sqrt(state.angular_acceleration_b.norm() / limits.angular_acceleration)});
  }
  return stretch;
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
  TimedMotion timed;
  timed.motion = motion;
  for (const Loop& loop : motion.loops) {
    timed.loop_duration_s.push_back(loop.duration_s *
                                    SmallestStretch(motion.base_pose, loop, limits));
  }
  return timed;
}

}  // namespace calibrato
