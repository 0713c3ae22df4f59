#pragma once

#include <limits>
#include <string>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/evaluation/contestant.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"
#include "calibrato/sensors/rig.h"
#include "calibrato/simulation/fidelity.h"

namespace calibrato {

/// What one rig recorded while its carrier made one motion.
struct TrialRecording {
  std::vector<BoardView> views;
  ImuStream imu;  ///< Empty for the intrinsic task at fidelity `fast`.
  int num_frames = 0;
};

/// Simulates the motion and, at fidelity `rendered`, searches the images for the board.
/// @throws InputError as SimulateRun does.
[[nodiscard]] TrialRecording RecordForTrial(Task task, const Rig& rig,
                                            const ExecutableMotion& motion, Fidelity fidelity,
                                            const Rng& noise);

/// One rig calibrated by one motion. A figure that there is not is NaN: those of the other task,
/// all of a failed trial.
struct Trial {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  /// Why there is no result to be trusted; empty if there is one.
  std::string failure;
  double relative_error = kNone;  ///< The paper's: of fu fv pu pv, or of T_cam_imu [-].
  // Intrinsic.
  double focal_error_px = kNone;   ///< Root mean square over fu and fv.
  double centre_error_px = kNone;  ///< Root mean square over pu and pv.
  /// What the error of the distortion alone does to pixels: PredictionErrorPx with the true fu fv
  /// pu pv. Where true and estimated model differ in their intrinsics: NaN.
  double distortion_error_px = kNone;
  // Extrinsic.
  double translation_error_m = kNone;
  double rotation_error_rad = kNone;
  double time_offset_error_s = kNone;  ///< Its absolute value.
  double a_optimality_conditional = kNone;
  /// OriginalAOptimality: the only one to be set beside the paper's column.
  double a_optimality_original = kNone;
  // Both.
  double prediction_error_px = kNone;
  double a_optimality = kNone;
  double nees =
      kNone;           ///< Squared error of fu fv pu pv or of T_cam_imu over the stated covariance.
  int num_frames = 0;  ///< That the calibration was given.
  double path_length_m = 0.0;
  double path_length_original_m = 0.0;
  double motion_s = 0.0;
};

/// Dimension of Trial::nees: 4 intrinsic, 6 extrinsic.
[[nodiscard]] int NeesDimension(Task task);

/// Records and calibrates by room calibration's solvers, which are told nothing of the truth (for
/// the extrinsic task the camera's intrinsics, as in the paper).
/// @throws InputError if the simulation can't be made for want of a library (fidelity `rendered`);
/// what this one motion does not allow is a failure of the trial.
[[nodiscard]] Trial RunTrial(Task task, const Rig& rig, const ExecutableMotion& motion,
                             Fidelity fidelity, const Rng& noise);

/// The same from a recording at hand.
[[nodiscard]] Trial CalibrateRecording(Task task, const Rig& rig, const TrialRecording& recording);

}  // namespace calibrato
