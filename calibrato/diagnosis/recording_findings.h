#pragma once

#include <vector>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/diagnosis/finding.h"

namespace calibrato {

/// How the board was held before the camera in the views that are used: coverage ranges not reached
/// (warn), parts of the image that were never covered, the board never tilted, always at one
/// distance, always near.
[[nodiscard]] std::vector<Finding> FindingsOnBoardPoses(const CameraProblem& problem,
                                                        const CameraCalibration& calibration);

/// What does not fit the rest: outliers that were left out, views with large errors, corners that
/// are worse while the board moves fast.
[[nodiscard]] std::vector<Finding> FindingsOnCorners(const CameraProblem& problem,
                                                     const CameraCalibration& calibration);

}  // namespace calibrato
