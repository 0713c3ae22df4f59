#pragma once

#include <vector>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/diagnosis/finding.h"

namespace calibrato {

/// What is wrong with a camera calibration, and the remedy (thresholds: docs/formats.md section 1).
/// - fail: not converged, rank-deficient, sigma(f) / f above 1 %, fewer than 3 views;
/// - warn: a coverage range not reached, halves of the views that disagree by more than 3 sigma in
///   one of fu fv pu pv (both halves are calibrated for it).
[[nodiscard]] std::vector<Finding> DiagnoseCamera(const CameraProblem& problem,
                                                  const CameraCalibration& calibration);

}  // namespace calibrato
