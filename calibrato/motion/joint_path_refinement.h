#pragma once

#include "calibrato/motion/joint_path_cost.h"
#include "calibrato/motion/looped_path.h"

namespace calibrato {

/// Moves the joints along the arm's redundancy, at all way-points of all loops together and with
/// one start for all, to the local minimum of the cost:
/// Gauss-Newton steps (one unknown a way-point along its null direction; tridiagonal in each loop,
/// bordered by the start), damped after Levenberg, every way-point then brought back to its pose.
///
/// @param path  Joint angles near the poses; any beyond repair are left as they are.
[[nodiscard]] JointPath RefineJointPath(const PosePath& poses, const JointPath& path,
                                        const JointPathCost& path_cost);

}  // namespace calibrato
