#pragma once

#include <variant>
#include <vector>

#include "calibrato/motion/carrier.h"
#include "calibrato/motion/joint_path_cost.h"
#include "calibrato/motion/looped_path.h"

namespace calibrato {

/// Between way-points no joint may turn by more: a path that needs to would be two paths [rad].
inline constexpr double kMaxJointStep = 0.5;

/// Every way-point's joint angles on a grid of the last joint's.
using JointChoices = LoopedPath<std::vector<JointVector>>;
/// Those far outside the limits are left out, unless there are no better. Empty where the pose is
/// out of the arm's reach.
[[nodiscard]] JointChoices JointChoicesAlong(const PosePath& poses, const JointRange& range = {});

/// The same with a grid four times as fine where no choice stays 0.1 rad within the limits: what
/// fits there may stand between the coarse grid's lines.
[[nodiscard]] JointChoices FinerWhereTight(const PosePath& poses, const JointChoices& choices,
                                           const JointRange& range = {});

/// Joint paths through the choices, all loops from one start: for each start the cheapest, by
/// dynamic programming over whole loops.
/// @return  Of up to four starts that differ much, cheapest first; or a refusal (without its number
/// of way-points) if no path gets along with steps of kMaxJointStep.
/// @pre No way-point is without choices.
[[nodiscard]] std::variant<std::vector<JointPath>, Refusal> SearchJointPaths(
    const JointChoices& choices, const JointPathCost& path_cost);

}  // namespace calibrato
