#pragma once

#include <vector>

#include "calibrato/motion/carrier.h"
#include "calibrato/motion/looped_path.h"

namespace calibrato {

/// The smallest factor >= 1 by which a loop of `duration_s` must be stretched for every joint's
/// velocity, acceleration, jerk and torque to stay within the limits, at 500 instants. Between
/// way-points the joints follow LoopJointSpline.
/// @return Infinity if the torques do not even hold the arm still.
[[nodiscard]] double SmallestStretch(const JointPath& path, size_t loop, double duration_s,
                                     const PandaLimits& limits = Limits());

/// The joint angles of all way-points with the times at which they are passed.
[[nodiscard]] std::vector<JointSample> TimedJointPath(const JointPath& path,
                                                      const std::vector<double>& loop_duration_s);

}  // namespace calibrato
