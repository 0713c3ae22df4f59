#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/mdp/design_problem.h"
#include "calibrato/motion/motion.h"

// Motions by direct design: the expected information of a motion, improved by its gradient within
// the free carrier's limits, without executing anything. After Hausman, Preiss, Sukhatme, Weiss,
// "Observability-aware trajectory optimization for self-calibration", RA-L 2017, and Preiss,
// Hausman, Sukhatme, Weiss, "Trajectory optimization for self-calibration and navigation", RSS
// 2017. It is the rival that learning has to beat.

namespace calibrato {

struct MotionDesignOptions {
  int max_evaluations = 300;  ///< Of objective and gradient over all rigs, from one start.
};

struct MotionDesign {
  Motion motion;      ///< Within the problem's limits, with the durations that it takes.
  double loss = 0.0;  ///< ExpectLoss of it.
  int64_t num_information_evaluations = 0;  ///< As NumEvaluations counts.
};

/// Improves a motion until nothing more is gained or the evaluations are used up. Variables are
/// each loop's coefficients and the logarithm of its duration; what exceeds path and time is scaled
/// back inside the objective; the carrier's other limits (loop_demands.h) are charged by the square
/// of their excess; the minimiser is L-BFGS (Liu and Nocedal 1989; NLopt's), and FitToBudget takes
/// out what excess is left. A local optimum, which depends on the start; deterministic.
///
/// @param start  Need not fit within limits, path or time.
/// @return nothing if the start teaches nothing about any of the rigs, or fits at no scale.
[[nodiscard]] std::optional<MotionDesign> DesignMotion(const MotionDesignProblem& problem,
                                                       const Motion& start,
                                                       const MotionDesignOptions& options = {});

struct MultistartOptions {
  int num_starts = 6;  ///< Random motions, fitted. >= 1.
  /// Of objective and gradient over all rigs: from each start, then once more from the best.
  int evaluations_per_start = 200;
  int evaluations_of_best = 600;
};

/// What design(0), .., design(n - 1) give, in this order.
using DesignMany = std::function<std::vector<std::optional<MotionDesign>>(
    size_t n, const std::function<std::optional<MotionDesign>(size_t)>& design)>;

/// DesignMotion from several starts, and once more from the best: the planner `fisher`.
/// @param design_many  Who designs from the starts; by default the threads of this process.
/// @return nothing if nothing is learned from any start.
[[nodiscard]] std::optional<MotionDesign> DesignFromManyStarts(
    const MotionDesignProblem& problem, const MultistartOptions& options, const Rng& rng,
    const DesignMany& design_many = nullptr);

}  // namespace calibrato
