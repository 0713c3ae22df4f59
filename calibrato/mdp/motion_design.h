#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/calibration/design_criterion.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/motion.h"
#include "calibrato/sensors/rig.h"

// Motions by direct design: the expected information of a motion, improved by its gradient within
// the free carrier's limits, without executing anything. After Hausman, Preiss, Sukhatme, Weiss,
// "Observability-aware trajectory optimization for self-calibration", RA-L 2017, and Preiss,
// Hausman, Sukhatme, Weiss, "Trajectory optimization for self-calibration and navigation", RSS
// 2017. It is the rival that learning has to beat.

namespace calibrato {

struct MotionDesignProblem {
  Task task = Task::kIntrinsic;
  /// What is believed of the rig before any data: one nominal rig, draws from a distribution (a
  /// robust design), or the truth (an oracle). At least one.
  std::vector<Rig> rigs;
  int num_loops = 4;
  BasePose base_pose;
  DesignCriterion criterion = DesignCriterion::kA;
  double coefficient_limit = 0.102;  ///< Of every coefficient before scaling, > 0.
  double max_path_m = 1e9;           ///< Of all loops together (path_length_m) [m].
  double max_duration_s = 1e9;       ///< Of all loops together [s].
  FreeCarrierLimits limits;
};

struct MotionDesignOptions {
  int max_evaluations = 300;  ///< Of objective and gradient over all rigs, from one start.
};

struct MotionDesign {
  Motion motion;  ///< With the durations that keep it within the carrier's limits.
  /// Mean over the rigs of half the logarithm of the criterion: of a sigma's scale.
  double objective = 0.0;
  double largest_violation = 0.0;  ///< Of any constraint, as a share of its limit; <= 0: none.
  int64_t num_information_evaluations = 0;  ///< Candidate motions x rigs.
};

/// Improves a motion until nothing more is gained or the evaluations are used up, by the method of
/// moving asymptotes (Svanberg 2002; NLopt's MMA) over coefficients and the logarithms of the
/// durations, with the demands of loop_demands.h as constraints. A local optimum, which depends on
/// the start. Deterministic.
///
/// @param start  Need not fit within limits, path or time.
/// @return nothing if the start teaches nothing about one of the rigs.
[[nodiscard]] std::optional<MotionDesign> DesignMotion(const MotionDesignProblem& problem,
                                                       const Motion& start,
                                                       const MotionDesignOptions& options = {});

}  // namespace calibrato
