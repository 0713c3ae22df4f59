#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calibrato/calibration/design_criterion.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/loop_kinematics.h"
#include "calibrato/motion/motion.h"
#include "calibrato/sensors/rig.h"

// What those who plan motions have to solve, whatever their method.

namespace calibrato {

struct MotionDesignProblem {
  Task task = Task::kIntrinsic;  ///< kJoint: the mean of both losses.
  /// What is believed of the rig before any data: one nominal rig, draws from a distribution (a
  /// robust design), or the truth (an oracle). At least one.
  std::vector<Rig> rigs;
  int num_loops = 4;
  /// The first loops of the start stay as they are: those that were executed already. In [0,
  /// num_loops).
  int num_fixed_loops = 0;
  BasePose base_pose;
  DesignCriterion criterion = DesignCriterion::kA;
  double coefficient_limit = 0.102;  ///< Of every coefficient before scaling, > 0.
  double max_path_m = 1e9;           ///< Of all loops together (path_length_m) [m].
  double max_duration_s = 1e9;       ///< Of all loops together [s].
  /// Frames count only so far inside the border, beyond the task's own margin [px] >= 0.
  double extra_margin_px = 0.0;
  int frames_per_loop = 50;  ///< That a motion is judged by (motion_information.h).
  FreeCarrierLimits limits;
};

/// The loss of a rig of which nothing is learned: far worse than any other.
inline constexpr double kNothingIsLearned = 20.0;

/// What a motion is expected to leave unknown.
struct ExpectedLoss {
  /// Mean over the rigs of half the logarithm of the criterion, of a sigma's scale: two motions
  /// whose losses differ by x differ by about a factor exp(x) in their errors. (Of log det, which
  /// is a logarithm already, per parameter.) A rig of which nothing is learned counts
  /// kNothingIsLearned.
  double value = 0.0;
  std::vector<LoopGradient> gradient;  ///< One a loop; empty unless asked for.
};

/// How many information evaluations the expected loss of one motion takes: one for each rig and set
/// of parameters (the joint task has two), with or without its gradient. What all planners are
/// counted by.
[[nodiscard]] int64_t NumEvaluations(const MotionDesignProblem& problem);

/// Costs NumEvaluations.
[[nodiscard]] ExpectedLoss ExpectLoss(const MotionDesignProblem& problem, const Motion& motion,
                                      bool want_gradient = false);

/// The motion of the same shape that fits the problem: its coefficients clipped to their limit and
/// multiplied by one factor in (0, 1] for path, reach, height and view; each loop's duration as
/// wished for or, if it is longer, the shortest that speeds and accelerations allow. A limited time
/// is used to its end: what loops wish beyond their shortest is shortened or lengthened alike.
/// Fixed loops are left alone and charged.
/// @return nothing if no factor fits.
[[nodiscard]] std::optional<Motion> FitToBudget(const MotionDesignProblem& problem, Motion motion);

}  // namespace calibrato
