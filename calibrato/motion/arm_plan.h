#pragma once

#include <variant>

#include "calibrato/motion/arm.h"
#include "calibrato/motion/carrier.h"

namespace calibrato {

/// Where the controlled frame is with the arm at its start.
[[nodiscard]] BasePose StartPose(const Arm& arm);

/// Plans a motion on an arm that its owner described. From each way to stand at the base pose,
/// nearest to arm.start first, the joints follow the poses through all loops; of a seventh joint's
/// freedom they take what is nearest to that start. The first path is taken that keeps all that the
/// Panda's keep (arm_carrier.h): reach, the board in view, joint limits, steps of joints, distance
/// from singularities, clearance from the surroundings and from itself, the owner's limits
/// (rig.arm_limits), and that between way-points strays by no more than 1 mm and 1 mrad. Time is
/// laid along it within velocities, accelerations and jerks, not torques.
///
/// @return  The motion with its carrier kFree: its poses and times are the arm's, its joint path is
/// for JointTrajectory. Or, of the path with the fewest bad way-points, why it is refused.
[[nodiscard]] std::variant<TimedMotion, Refusal> PlanOnArm(const Arm& arm, const Motion& motion,
                                                           const Rig& rig);

/// As PlanScaledToFit. @throws InputError if not even the base pose fits.
[[nodiscard]] TimedMotion PlanScaledToFit(const Arm& arm, const Motion& motion, const Rig& rig);

}  // namespace calibrato
