#pragma once

#include <optional>

#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/diagnosis/finding.h"

namespace calibrato {

/// How large the board is, by the accelerometer: images alone show the same of a board twice as
/// large at twice the distance.
struct BoardScaleCheck {
  double scale = 1.0;  ///< True size over the one that the target states.
  double sigma = 0.0;
  /// The calibration with that size, and the size among its unknowns.
  CameraImuCalibration calibration;
};

/// First by one Gauss-Newton step with the size as a further unknown; where that is more than half
/// a percent and five sigmas away from 1, or where the calibration did not converge, by solving
/// again with it.
/// @return nothing where the board is as stated, or where the recording does not tell.
/// @pre the calibration has a state, and the problem holds the board's size
[[nodiscard]] std::optional<BoardScaleCheck> CheckBoardScale(
    const CameraImuProblem& problem, const CameraImuCalibration& calibration);

/// "the board is 2.4 % larger than its target says": fail beyond one percent, else warn. With it,
/// what else does not fit is likely to be its consequence.
[[nodiscard]] Finding BoardScaleFinding(const BoardScaleCheck& check);

}  // namespace calibrato
