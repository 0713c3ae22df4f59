#pragma once

#include "calibrato/base/rng.h"
#include "calibrato/calibration/design_criterion.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/motion.h"
#include "calibrato/sensors/rig.h"
#include "calibrato/simulation/fidelity.h"

namespace calibrato {

/// How well one rig was calibrated by one motion.
struct MotionJudgement {
  /// Of what the solver states after it saw the data, in the sense of ExpectLoss: half the
  /// logarithm of the criterion. Detections that were lost and noise that was larger than stated
  /// are in it; the luck of one draw of the noise is not.
  double stated_loss = 0.0;
  double nees = 0.0;            ///< Squared error over the stated covariance, and ...
  int nees_dimension = 0;       ///< ... what it is on average if what is stated is true.
  double relative_error = 0.0;  ///< The paper's [-]; of the joint task, the sum of both.
};

/// Of a rig about which nothing was learned: the prior's.
[[nodiscard]] MotionJudgement JudgeNothingLearned(Task task, const Rig& rig,
                                                  DesignCriterion criterion);

/// Executes the motion, records and calibrates. Where the data do not determine the calibration,
/// loss and error are those of the prior.
/// @throws InputError as RecordLoop.
[[nodiscard]] MotionJudgement JudgeMotion(Task task, const Rig& rig, const TimedMotion& motion,
                                          Fidelity fidelity, DesignCriterion criterion,
                                          const Rng& rng);

}  // namespace calibrato
