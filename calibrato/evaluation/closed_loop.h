#pragma once

#include <cstdint>
#include <optional>

#include "calibrato/base/rng.h"
#include "calibrato/evaluation/contestant.h"
#include "calibrato/evaluation/trial.h"
#include "calibrato/mdp/design_problem.h"
#include "calibrato/simulation/fidelity.h"

// Motions that answer what was measured so far, and those of an oracle.

namespace calibrato {

/// A motion made for one rig, and what it took beside what its start took.
struct MotionForRig {
  ExecutableMotion motion;
  int64_t num_information_evaluations = 0;
  int num_designs = 0;  ///< How often what was left was designed anew.
};

/// The same motion, its rest shrunk until the carrier can make the whole: what was executed can't
/// be changed any more. @return Nothing if it never fits.
[[nodiscard]] std::optional<ExecutableMotion> WithRestThatFits(Motion motion, size_t num_executed,
                                                               Carrier carrier, const Rig& rig);

struct ClosedLoopOptions {
  int evaluations_per_design = 60;  ///< Of objective and gradient, each time (DesignMotion).
};

/// What is believed of a rig after some loops: whatever one look at the board or the data sheets
/// tell (the board and its place, the camera's mount, rates, noise) as it is; for the intrinsic
/// task the camera as calibrated from what was recorded; for the extrinsic one, in which the camera
/// is known, T_cam_imu as calibrated. The time offset is believed to be 0: nothing is designed by
/// it.
/// @return nothing while the data do not determine it.
[[nodiscard]] std::optional<Rig> BelievedAfter(Task task, const Rig& rig,
                                               const TrialRecording& recording);

/// Plays a motion loop by loop. After each but the last the rig is calibrated from all that was
/// recorded, and what is left of the motion is designed anew for it (DesignMotion with the loops so
/// far fixed), within the problem's path and time; while the calibration is not determined, what
/// is left stays as it was.
///
/// What the first loops record here is what they record when the whole motion is judged with the
/// same noise, on the free carrier; on the arm, whose dynamics see the whole motion, alike.
///
/// @param problem  Its limits; its rigs and base pose are not used.
/// @param start  The motion that was designed before any data, as many loops as the problem.
/// @throws InputError if the carrier can't make the start before this rig's board at any scale.
[[nodiscard]] MotionForRig PlayClosedLoop(const MotionDesignProblem& problem, const Motion& start,
                                          Carrier carrier, Fidelity fidelity, const Rig& rig,
                                          const Rng& noise, const ClosedLoopOptions& options = {});

/// The motion of an oracle: designed for the rig as it is, from the same start.
/// @throws InputError likewise.
[[nodiscard]] MotionForRig DesignForTruth(const MotionDesignProblem& problem, const Motion& start,
                                          Carrier carrier, const Rig& rig, int max_evaluations);

}  // namespace calibrato
