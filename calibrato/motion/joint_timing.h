#pragma once

#include <vector>

#include "calibrato/motion/carrier.h"
#include "calibrato/motion/looped_path.h"

namespace calibrato {

/// The smallest factor >= 1 by which a loop of `duration_s` must be stretched for every joint's
/// velocity and acceleration to stay within the arm's limits, at 500 instants. Between way-points
/// the joints follow the periodic cubic spline through them.
[[nodiscard]] double SmallestStretch(const JointPath& path, size_t loop, double duration_s);

/// The joint angles of all way-points with the times at which they are passed.
[[nodiscard]] std::vector<JointSample> TimedJointPath(const JointPath& path,
                                                      const std::vector<double>& loop_duration_s);

}  // namespace calibrato
