#include "calibrato/motion/carrier.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <utility>

#include "calibrato/geometry/rpy.h"
#include "calibrato/motion/arm_carrier.h"
#include "calibrato/motion/free_carrier.h"
#include "calibrato/motion/joint_motion.h"
#include "calibrato/motion/loop_state.h"
#include "calibrato/motion/scale_to_fit.h"

namespace calibrato {
namespace {

std::string FormatDigits(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.*g", digits, value);
  return text;
}

}  // namespace

Rigid3 ArmBaseInWorld() { return {RotationFromRpy({0.0, 0.0, std::numbers::pi})}; }

void TimedMotion::SetTimeLaws(const std::vector<TimeLaw>& laws) {
  loop_duration_s.clear();
  loop_phase_control_points.clear();
  for (const TimeLaw& law : laws) {
    loop_duration_s.push_back(law.duration_s);
    loop_phase_control_points.push_back(law.control_points);
  }
  if (std::ranges::all_of(laws, [](const TimeLaw& law) { return law.control_points.empty(); })) {
    loop_phase_control_points.clear();
  }
}

TimeLaw TimedMotion::LawOf(size_t loop) const {
  if (loop_phase_control_points.empty()) return {loop_duration_s[loop], {}};
  return {loop_duration_s[loop], loop_phase_control_points[loop]};
}

double TimedMotion::duration_s() const {
  return std::accumulate(loop_duration_s.begin(), loop_duration_s.end(), 0.0);
}

CarrierState TimedMotion::At(double t_s) const {
  assert(!motion.loops.empty() && motion.loops.size() == loop_duration_s.size());
  size_t i = 0;
  while (i + 1 < motion.loops.size() && t_s > loop_duration_s[i]) t_s -= loop_duration_s[i++];
  const Phase phase = loop_phase_control_points.empty()
                          ? QuinticPhaseAt(t_s, loop_duration_s[i])
                          : PhaseAt(loop_phase_control_points[i], t_s, loop_duration_s[i]);
  return LoopStateAt(motion.base_pose, motion.loops[i].coefficients, phase);
}

CarrierPath PlannedPath(const TimedMotion& motion) {
  CarrierPath path{motion.duration_s(), [motion](double t_s) { return motion.At(t_s); }, {}};
  if (!motion.joint_path.empty()) {
    path.joints = [joints = JointTrajectory(motion)](double t_s) {
      return joints.At(t_s).position;
    };
  }
  return path;
}

Value ToValue(const TimedMotion& timed) {
  Value value = ToValue(timed.motion);
  value.Set("scale", timed.scale).Set("loop_duration_s", Value::Numbers(timed.loop_duration_s));
  if (!timed.loop_phase_control_points.empty()) {
    Value phases = Value::Array();
    for (const std::vector<double>& points : timed.loop_phase_control_points) {
      phases.Append(Value::Numbers(points));
    }
    value.Set("loop_phase_control_points_rad", std::move(phases));
  }
  if (!timed.joint_path.empty()) {
    Value path = Value::Array();
    for (const JointSample& sample : timed.joint_path) {
      Value joints = Value::Array();
      joints.Append(sample.t_s);
      for (const double angle : sample.position) joints.Append(angle);
      path.Append(std::move(joints));
    }
    value.Set("joint_path_t_s_q_rad", std::move(path));
  }
  return value;
}

std::string Refusal::Describe() const {
  // As many digits as it takes to see the difference.
  constexpr int kFewDigits = 3;
  constexpr int kManyDigits = 12;
  int digits = kFewDigits;
  while (digits < kManyDigits && FormatDigits(value, digits) == FormatDigits(bound, digits)) {
    ++digits;
  }
  // NaN: the value is how far off, and there is nothing to hold it against.
  const std::string allowed =
      std::isnan(bound) ? "" : ", allowed " + FormatDigits(bound, digits) + " " + unit;
  return limit + " at loop " + std::to_string(loop + 1) + ", way-point " +
         std::to_string(way_point) + ": " + FormatDigits(value, digits) + " " + unit + allowed +
         " (" + std::to_string(num_bad_way_points) + " of " + std::to_string(num_way_points) +
         " way-points do not fit)";
}

std::variant<TimedMotion, Refusal> PlanMotion(const Motion& motion, const Rig& rig) {
  assert(!motion.loops.empty());
  return motion.carrier == Carrier::kArm ? PlanOnArm(motion, rig) : PlanOnFreeCarrier(motion, rig);
}

TimedMotion PlanScaledToFit(const Motion& motion, const Rig& rig) {
  return LargestThatFits(motion, "the " + CarrierName(motion.carrier) + " carrier",
                         [&](const Motion& scaled) { return PlanMotion(scaled, rig); });
}

}  // namespace calibrato
