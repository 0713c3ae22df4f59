#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/calibration/design_criterion.h"
#include "calibrato/motion/loop_kinematics.h"
#include "calibrato/motion/motion.h"
#include "calibrato/sensors/rig.h"

// What a motion would teach a calibration, without executing, measuring or solving: for those who
// plan. Derivation and accuracy: docs/expected-information.md.

namespace calibrato {

struct MotionInformationOptions {
  DesignCriterion criterion = DesignCriterion::kA;
  bool want_gradient = false;
  /// A frame counts with 1 / (1 + exp(-(margin - wanted margin) / this)), its margin being how far
  /// the outermost corner is inside the image [px] > 0: a step would have no derivative.
  double visibility_softness_px = 1.0;
  /// Frames count when the board is so much further inside the image than is wanted [px] >= 0: for
  /// those who do not trust the border.
  double extra_margin_px = 0.0;
  /// Frames that each loop is judged by, >= 16 (the fourth harmonic needs so many), whatever the
  /// camera's rate: their weights make up for it.
  int frames_per_loop = 50;
};

struct MotionInformation {
  /// Of fu fv pu pv in px, or of T_c_i in 1e-3 rad and 1e-3 m (information.h).
  double criterion = 0.0;
  /// Marginal: of the camera's parameters in their order; or of [T_c_i, time offset].
  Eigen::MatrixXd covariance;
  double num_frames = 0.0;             ///< Expected to count.
  std::vector<LoopGradient> gradient;  ///< One a loop, of the criterion; empty unless asked for.
};

/// Of the camera's parameters, from frames at the rig's rate with its corner noise at rest, each
/// frame of unknown pose. Frames are spread evenly over each loop, a fixed number with the weight
/// of as many as the rate gives in its duration, so that the number is smooth in the duration.
/// Frames count when the board is at least 8 px inside the image: the whole of it, also of an
/// AprilGrid, so of that one the number is a lower bound.
/// @param motion  Its durations are those of the execution (a carrier may stretch them).
/// @return nothing where the frames do not determine the camera.
[[nodiscard]] std::optional<MotionInformation> ExpectIntrinsicInformation(
    const Rig& rig, const Motion& motion, const MotionInformationOptions& options = {});

/// Of T_c_i and time offset, from the same frames (board inside the image) and the rig's IMU, whose
/// noise densities count, at 50 instants a second.
/// @return nothing where they do not determine the extrinsics.
[[nodiscard]] std::optional<MotionInformation> ExpectExtrinsicInformation(
    const Rig& rig, const Motion& motion, const MotionInformationOptions& options = {});

}  // namespace calibrato
