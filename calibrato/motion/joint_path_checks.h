#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "calibrato/motion/arm_clearance.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/joint_motion.h"
#include "calibrato/motion/looped_path.h"

// What every arm's joint path has to keep, way-point by way-point, and the time along it. Each
// check gives nothing where all is well, else a refusal without loop, way-point and numbers of
// them.

namespace calibrato {

/// T_b_e at the motion's way-points.
[[nodiscard]] PosePath PosesAlong(const Motion& motion);

/// Of the first joint that leaves its range.
[[nodiscard]] std::optional<Refusal> CheckRange(const JointRange& taken, const JointRange& range);

/// The joint limits at a way-point, and the step to it (joint_path_search.h).
[[nodiscard]] std::optional<Refusal> CheckJoints(const JointPath& path, const JointRange& range,
                                                 size_t loop, int way_point);

/// How far the last joint turns from its start, on the way to a way-point.
/// @param last_joint  From 0.
[[nodiscard]] std::optional<Refusal> CheckLastJointTurn(const LoopJointSpline& spline,
                                                        const JointVector& start,
                                                        Eigen::Index last_joint,
                                                        const ArmLimits& limits, int way_point);

/// Between the arm and everything around it, on the way to a way-point, itself included.
[[nodiscard]] std::optional<Refusal> CheckClearance(const LoopJointSpline& spline,
                                                    const ClearanceCheck& check, double clearance_m,
                                                    int way_point);

/// What to try near a singularity.
inline constexpr char kAwayFromSingularity[] =
    "joints would have to turn without end there: choose another base_pose, make the motion "
    "smaller, or add --scale-to-fit";

/// One a loop.
[[nodiscard]] std::vector<LoopJointSpline> SplinesThrough(const JointPath& path);

/// The first of the way-points that `check` refuses, with the number of them.
/// @param check  (size_t loop, int way_point) -> std::optional<Refusal>
template <typename Check>
std::optional<Refusal> CheckWayPoints(size_t num_loops, const Check& check) {
  std::optional<Refusal> first;
  int num_bad_way_points = 0;
  for (size_t loop = 0; loop < num_loops; ++loop) {
    for (int i = 1; i <= kNumWayPoints; ++i) {
      std::optional<Refusal> refusal = check(loop, i);
      if (!refusal) continue;
      ++num_bad_way_points;
      if (first) continue;
      first = std::move(refusal);
      first->loop = static_cast<int>(loop);
      first->way_point = i;
    }
  }
  if (first) {
    first->num_bad_way_points = num_bad_way_points;
    first->num_way_points = kNumWayPoints * static_cast<int>(num_loops);
  }
  return first;
}

/// The motion along a path that keeps the limits of place: each loop as quick as the limits of the
/// joints and its own wish allow.
[[nodiscard]] TimedMotion TimedAlong(const Motion& motion, const JointPath& path,
                                     const PandaLimits& limits);

}  // namespace calibrato
