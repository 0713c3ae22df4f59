#include "calibrato/motion/joint_path_checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "calibrato/motion/joint_path_search.h"
#include "calibrato/motion/joint_timing.h"
#include "calibrato/motion/optimal_timing.h"

namespace calibrato {

PosePath PosesAlong(const Motion& motion) {
  PosePath poses;
  poses.start = LoopPoseAt(motion.base_pose, LoopCoefficients::Zero(), 0.0);
  for (const Loop& loop : motion.loops) {
    PosePath::Loop& loop_poses = poses.loops.emplace_back();
    for (int i = 1; i < kNumWayPoints; ++i) {
      loop_poses[i - 1] = LoopPoseAt(motion.base_pose, loop.coefficients, WayPointPhase(i));
    }
  }
  return poses;
}

std::optional<Refusal> CheckRange(const JointRange& taken, const JointRange& range) {
  Refusal refusal;
  refusal.unit = "rad";
  for (int i = 0; i < taken.lower.size(); ++i) {
    const std::string joint = "joint " + std::to_string(i + 1);
    refusal.value = taken.lower[i];
    refusal.limit = joint + " lower limit";
    refusal.bound = range.lower[i];
    if (!(refusal.value >= refusal.bound)) return refusal;
    refusal.value = taken.upper[i];
    refusal.limit = joint + " upper limit";
    refusal.bound = range.upper[i];
    if (!(refusal.value <= refusal.bound)) return refusal;
  }
  return std::nullopt;
}

std::optional<Refusal> CheckJoints(const JointPath& path, const JointRange& range, size_t loop,
                                   int way_point) {
  const JointVector& q = path.At(loop, way_point);
  if (std::optional<Refusal> refusal = CheckRange({q, q}, range)) return refusal;
  const JointVector& before = path.At(loop, way_point - 1);
  Refusal refusal;
  refusal.unit = "rad";
  refusal.bound = kMaxJointStep;
  for (int i = 0; i < q.size(); ++i) {
    refusal.limit = "joint " + std::to_string(i + 1) + " step between way-points";
    refusal.value = std::abs(q[i] - before[i]);
    if (!(refusal.value <= refusal.bound)) return refusal;
  }
  return std::nullopt;
}

std::optional<Refusal> CheckLastJointTurn(const LoopJointSpline& spline, const JointVector& start,
                                          Eigen::Index last_joint, const ArmLimits& limits,
                                          int way_point) {
  const JointRange taken = spline.RangeOnTheWayTo(way_point);
  Refusal refusal;
  refusal.limit = "turn of the wrist";
  refusal.unit = "rad";
  refusal.value = std::max(start[last_joint] - taken.lower[last_joint],
                           taken.upper[last_joint] - start[last_joint]);
  refusal.bound = limits.max_wrist_turn;
  if (refusal.value <= refusal.bound) return std::nullopt;
  return refusal;
}

std::optional<Refusal> CheckClearance(const LoopJointSpline& spline, const ClearanceCheck& check,
                                      double clearance_m, int way_point) {
  constexpr int kNumInstants = 4;
  Refusal refusal;
  refusal.unit = "m";
  refusal.bound = clearance_m;
  for (int k = 1; k <= kNumInstants; ++k) {
    const double share = static_cast<double>(k) / kNumInstants;
    const double theta = WayPointPhase(way_point - 1) + share * WayPointPhase(1);
    const Phase phase{.theta = theta, .first = 0.0, .second = 0.0, .third = 0.0};
    const Clearance clearance = check.Least(spline.At(phase).position);
    refusal.limit = "clearance of " + clearance.what;
    refusal.value = clearance.distance_m;
    if (!(clearance.distance_m >= clearance_m)) return refusal;
  }
  return std::nullopt;
}

std::vector<LoopJointSpline> SplinesThrough(const JointPath& path) {
  std::vector<LoopJointSpline> splines;
  for (size_t loop = 0; loop < path.loops.size(); ++loop) splines.emplace_back(path, loop);
  return splines;
}

namespace {

TimeLaw TimeLawOf(const Motion& motion, const JointPath& path, size_t loop,
                  const PandaLimits& limits) {
  const auto stretch = [&](const TimeLaw& law) { return SmallestStretch(path, loop, law, limits); };
  if (motion.timing == Timing::kOptimal) {
    const LoopJointSpline spline(path, loop);
    return FastestTimeLaw([&](double theta) { return PhaseLimitsOfJoints(spline, theta, limits); },
                          stretch);
  }
  TimeLaw law{motion.loops[loop].duration_s, {}};
  law.duration_s *= stretch(law);
  return law;
}

}  // namespace

TimedMotion TimedAlong(const Motion& motion, const JointPath& path, const PandaLimits& limits) {
  std::vector<TimeLaw> laws;
  for (size_t loop = 0; loop < motion.loops.size(); ++loop) {
    laws.push_back(TimeLawOf(motion, path, loop, limits));
  }
  TimedMotion timed;
  timed.motion = motion;
  timed.SetTimeLaws(laws);
  timed.joint_path = TimedJointPath(path, laws);
  return timed;
}

}  // namespace calibrato
