#pragma once

#include <string>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/mdp/motion_design.h"

namespace calibrato {

/// Planners alone: each searches the motion of least expected loss under the same budget of
/// information evaluations, without networks and episodes. By name (docs/formats.md):
///
///     fisher           DesignFromManyStarts for the first rig, then DesignMotion for all
///     best-of-1000     random motions as the policy `random` draws them, fitted to the problem;
///                      1000 of them, whatever the budget
///     random-shooting, pso, pso-p, cem, icem, cma-es
///                      search.h over coefficients, each candidate fitted to the problem
///     pso-paper        the paper's swarm (swarm.h), which takes gradients too; without the fit's
///
/// What they believe of the rig before any data are the problem's rigs.
[[nodiscard]] std::vector<std::string> PlanMethodNames();

/// @param num_evaluations  Of one motion for one rig each, >= 1; a gradient counts as one. Not
///     exceeded by more than a round of the method's.
/// @return nothing if no candidate teaches anything.
/// @throws InputError for an unknown name, or one that plans from a policy alone (q-library, sac).
[[nodiscard]] std::optional<MotionDesign> PlanByMethod(const std::string& method,
                                                       const MotionDesignProblem& problem,
                                                       int num_evaluations, const Rng& rng);

}  // namespace calibrato
