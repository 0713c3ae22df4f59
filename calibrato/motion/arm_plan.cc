#include "calibrato/motion/arm_plan.h"

#include <limits>
#include <optional>
#include <utility>

#include "calibrato/geometry/rpy.h"
#include "calibrato/motion/board_in_view.h"
#include "calibrato/motion/joint_path_checks.h"
#include "calibrato/motion/scale_to_fit.h"
#include "calibrato/motion/singularity.h"

namespace calibrato {
namespace {

Refusal OutOfReach(double rotation_and_way) {
  Refusal refusal;
  refusal.limit = "the arm does not get there: left of turn and way";
  refusal.value = rotation_and_way;
  refusal.bound = std::numeric_limits<double>::quiet_NaN();
  refusal.unit = "rad, m";
  return refusal;
}

JointRange RangeOf(const Arm& arm, const ArmLimits& limits) {
  JointRange range{arm.limits.lower, arm.limits.upper};
  for (int i = 0; i < arm.num_joints(); ++i) {
    range.lower[i] = std::max(range.lower[i], limits.joint_lower[i]);
    range.upper[i] = std::min(range.upper[i], limits.joint_upper[i]);
  }
  return range;
}

// The joints along the poses, from one way to stand at their start.
std::variant<JointPath, Refusal> Follow(const Arm& arm, const PosePath& poses,
                                        const JointVector& start) {
  JointPath path;
  path.start = start;
  for (size_t loop = 0; loop < poses.loops.size(); ++loop) {
    path.loops.emplace_back();
    for (int i = 1; i < kNumWayPoints; ++i) {
      const JointVector before = path.At(loop, i - 1);
      const std::optional<JointVector> q = InverseNear(arm, poses.At(loop, i), before, start);
      if (!q) {
        Refusal refusal =
            OutOfReach(poses.At(loop, i).DifferenceTo(PoseOf(arm, before, nullptr)).norm());
        refusal.loop = static_cast<int>(loop);
        refusal.way_point = i;
        refusal.num_bad_way_points = 1;
        refusal.num_way_points = kNumWayPoints * static_cast<int>(poses.loops.size());
        return refusal;
      }
      path.loops[loop][static_cast<size_t>(i) - 1] = *q;
    }
  }
  return path;
}

std::optional<Refusal> CheckSingularity(const Arm& arm, const JointVector& q) {
  Refusal refusal;
  refusal.limit = "distance from a singularity";
  refusal.value = SingularityDistance(arm, q);
  refusal.bound = kMinSingularityDistance;
  refusal.unit = "m/rad";
  refusal.remedy = kAwayFromSingularity;
  if (refusal.value >= refusal.bound) return std::nullopt;
  return refusal;
}

// Between two way-points the joints follow a spline: where they turn quickly for what the hand
// does, it would lead the hand astray.
std::optional<Refusal> CheckStraying(const Arm& arm, const Motion& motion,
                                     const LoopJointSpline& spline, size_t loop, int way_point) {
  constexpr double kMost = 1e-3;
  const double theta = 0.5 * (WayPointPhase(way_point - 1) + WayPointPhase(way_point));
  const JointMotion joints = spline.At({.theta = theta, .first = 0.0, .second = 0.0, .third = 0.0});
  const Rigid3 wanted = LoopPoseAt(motion.base_pose, motion.loops[loop].coefficients, theta);
  Refusal refusal;
  refusal.limit = "turn and way off the motion between way-points";
  refusal.value = wanted.DifferenceTo(PoseOf(arm, joints.position, nullptr)).norm();
  refusal.bound = kMost;
  refusal.unit = "rad, m";
  refusal.remedy = kAwayFromSingularity;
  if (refusal.value <= refusal.bound) return std::nullopt;
  return refusal;
}

}  // namespace

BasePose StartPose(const Arm& arm) {
  const Rigid3 T_b_e = PoseOf(arm, arm.start, nullptr);
  return {T_b_e.t, RpyFromRotation(T_b_e.R)};
}

std::variant<TimedMotion, Refusal> PlanOnArm(const Arm& arm, const Motion& motion, const Rig& rig) {
  const PosePath poses = PosesAlong(motion);
  const size_t num_loops = motion.loops.size();
  if (std::optional<Refusal> unseen = CheckWayPoints(num_loops, [&](size_t loop, int i) {
        return CheckBoardInView(poses.At(loop, i), rig);
      })) {
    return *std::move(unseen);
  }
  const JointRange range = RangeOf(arm, rig.arm_limits);
  const ClearanceCheck clearance(
      rig, arm.parts, [&arm](const JointVector& q) { return FramesOf(arm, q); }, arm.num_joints());
  // Jerk jumps where pieces of path and time law meet, and is looked for at instants: the largest
  // may lie just beside one.
  constexpr double kShareOfJerk = 0.99;
  PandaLimits limits = arm.limits;
  limits.jerk *= kShareOfJerk;
  std::optional<Refusal> fewest_bad;
  for (const JointVector& posture : PosturesAt(arm, poses.start, range)) {
    std::variant<JointPath, Refusal> followed = Follow(arm, poses, posture);
    std::optional<Refusal> refusal;
    if (auto* gap = std::get_if<Refusal>(&followed)) {
      refusal = std::move(*gap);
    } else {
      const JointPath& path = std::get<JointPath>(followed);
      const std::vector<LoopJointSpline> splines = SplinesThrough(path);
      refusal = CheckWayPoints(num_loops, [&](size_t loop, int i) -> std::optional<Refusal> {
        std::optional<Refusal> bad = CheckJoints(path, range, loop, i);
        if (!bad) bad = CheckRange(splines[loop].RangeOnTheWayTo(i), range);
        if (!bad) {
          bad = CheckLastJointTurn(splines[loop], path.start, arm.num_joints() - 1, rig.arm_limits,
                                   i);
        }
        if (!bad) bad = CheckSingularity(arm, path.At(loop, i));
        if (!bad) bad = CheckStraying(arm, motion, splines[loop], loop, i);
        if (!bad) bad = CheckClearance(splines[loop], clearance, rig.arm_limits.clearance_m, i);
        return bad;
      });
      if (!refusal) {
        TimedMotion timed = TimedAlong(motion, path, limits);
        timed.motion.carrier = Carrier::kFree;
        return timed;
      }
    }
    if (!fewest_bad || refusal->num_bad_way_points < fewest_bad->num_bad_way_points) {
      fewest_bad = std::move(refusal);
    }
  }
  if (fewest_bad) return *std::move(fewest_bad);
  Refusal refusal = OutOfReach(poses.start.DifferenceTo(PoseOf(arm, arm.start, nullptr)).norm());
  refusal.limit =
      "no joint angles within the limits reach the base pose; from start_joints_rad, turn and way";
  refusal.way_point = kNumWayPoints;
  refusal.num_way_points = kNumWayPoints * static_cast<int>(num_loops);
  refusal.num_bad_way_points = refusal.num_way_points;
  return refusal;
}

TimedMotion PlanScaledToFit(const Arm& arm, const Motion& motion, const Rig& rig) {
  return LargestThatFits(motion, "the arm " + arm.name,
                         [&](const Motion& scaled) { return PlanOnArm(arm, scaled, rig); });
}

}  // namespace calibrato
