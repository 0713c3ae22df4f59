#pragma once

#include <variant>

#include "calibrato/motion/carrier.h"

namespace calibrato {

/// PlanMotion for Carrier::kArm. A closed-form inverse over a grid of the last joint gives all ways
/// to stand at each way-point; dynamic programming over whole loops finds joint paths from several
/// common starts; Gauss-Newton along the redundancy refines them; the quickest that fits is taken.
/// If all of them lead too near to an obstacle or a singularity, the search is made once more with
/// those distances as a cost, so that the elbow swings out of the way where that helps. A motion is
/// refused only if none fits.
///
/// Reach and the board's view are checked first, and joint limits and steps only where those hold.
/// Time is laid along the path by joint_timing.h.
[[nodiscard]] std::variant<TimedMotion, Refusal> PlanOnArm(const Motion& motion, const Rig& rig);

}  // namespace calibrato
