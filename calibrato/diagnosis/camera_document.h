#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/diagnosis/finding.h"

namespace calibrato {

/// A calibrated camera with all that is said about it.
struct CameraReportCard {
  std::string name;  ///< "cam0"
  CameraProblem problem;
  CameraCalibration calibration;
  std::vector<Finding> findings;
  std::vector<std::string> images_without_board;
};

/// result.json of `calibrate camera` (docs/formats.md section 3). With several cameras, which are
/// calibrated each on its own: the covariance is block-diagonal; coverage is the least of them,
/// information that of the camera with the largest a_optimality; findings name their camera.
/// @pre at least one
[[nodiscard]] Value CameraResult(const std::vector<CameraReportCard>& cameras);

/// What the report draws of one camera: corners, residuals, poses, the lens's curve. At most 200
/// views, evenly chosen.
[[nodiscard]] Value CameraPlots(const CameraReportCard& camera);

/// The result in plain text, for the terminal.
[[nodiscard]] std::string CameraText(const std::vector<CameraReportCard>& cameras);

/// The worst of all cameras' findings.
[[nodiscard]] Verdict VerdictOf(const std::vector<CameraReportCard>& cameras);

}  // namespace calibrato
