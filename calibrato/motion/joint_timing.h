#pragma once

#include <vector>

#include "calibrato/motion/carrier.h"
#include "calibrato/motion/joint_motion.h"
#include "calibrato/motion/looped_path.h"
#include "calibrato/motion/optimal_timing.h"
#include "calibrato/motion/time_law.h"

namespace calibrato {

/// The smallest factor >= 1 by which a loop must be stretched for every joint's velocity,
/// acceleration, jerk and torque to stay within the limits (stretch.h). Between way-points the
/// joints follow LoopJointSpline.
/// Torques are the Panda's: of an arm whose dynamics are not known, their limits are infinite.
/// @return Infinity if the torques do not even hold the arm still.
[[nodiscard]] double SmallestStretch(const JointPath& path, size_t loop, const TimeLaw& law,
                                     const PandaLimits& limits = Limits());

/// Velocity, acceleration and torque of the joints as limits of the phase. Viscous friction grows
/// as the root of the squared speed x; a line above it takes its place, exact at the largest x
/// where friction hinders (and half of it at rest), and at both ends where it helps.
[[nodiscard]] PhaseLimits PhaseLimitsOfJoints(const LoopJointSpline& spline, double theta,
                                              const PandaLimits& limits = Limits());

/// The joint angles of all way-points with the times at which they are passed.
/// @param laws  One a loop.
[[nodiscard]] std::vector<JointSample> TimedJointPath(const JointPath& path,
                                                      const std::vector<TimeLaw>& laws);

}  // namespace calibrato
