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
///     best-of-1000     random motions, fitted to the problem: 1000 of them, or as many as the
///                      budget allows
///     random-shooting, pso, pso-p, cem, icem, cma-es
///                      search.h over coefficients, each candidate fitted to the problem
///     pso-paper        the paper's swarm (swarm.h), which takes gradients too
///
/// All search the same box, that of the problem's coefficient_limit. What they believe of the rig
/// before any data are the problem's rigs.
[[nodiscard]] std::vector<std::string> PlanMethodNames();

/// @param num_evaluations  As NumEvaluations counts, >= 1. Not exceeded by more than a round of the
///     method's (15 motions of the paper's swarm, a start of `fisher`).
/// @return nothing if no candidate teaches anything.
/// @throws InputError for an unknown name, or one that plans from a policy alone (q-library, sac).
[[nodiscard]] std::optional<MotionDesign> PlanByMethod(const std::string& method,
                                                       const MotionDesignProblem& problem,
                                                       int num_evaluations, const Rng& rng);

}  // namespace calibrato
