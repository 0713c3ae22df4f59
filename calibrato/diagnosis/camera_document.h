#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/calibration/camera_rig_calibration.h"
#include "calibrato/detection/rejection.h"
#include "calibrato/diagnosis/camera_diagnosis.h"
#include "calibrato/diagnosis/finding.h"
#include "calibrato/sensors/board.h"

namespace calibrato {

/// One camera's part of what is said about a calibration.
struct CameraReportCard {
  std::string name;  ///< "cam0"
  CameraDiagnosis diagnosis;
  std::vector<std::string> images_without_board;
  RejectionCounts detection_rejected;  ///< What the search for the board left out.
};

/// One to N calibrated cameras with all that is said about them.
struct CameraRigReport {
  CameraRigProblem problem;
  CameraRigCalibration calibration;
  std::vector<CameraReportCard> cameras;  ///< In the same order.
  std::vector<Finding> findings;          ///< On all of them together.
};

/// What is worth saying of several cameras together: neighbours that could not be related, views
/// that did not fit the others of their frame, a bent board where its bending was estimated.
/// @param board  Where it is known: what to use instead of one that looks the same from several
/// sides.
[[nodiscard]] std::vector<Finding> RigFindings(const CameraRigCalibration& calibration,
                                               const std::optional<Board>& board);

/// result.json of `calibrate camera` (docs/formats.md section 3). Coverage is the least of the
/// calibrated cameras', information that of the camera with the largest a_optimality; with several
/// cameras, findings name theirs. Beyond the formats, each camera has `rejected` (what was left out
/// and why), `projection_uncertainty` and `checks` (checks_document.h).
[[nodiscard]] Value CameraResult(const CameraRigReport& report);

/// What the report draws of one camera: corners, residuals, poses, the lens's curve. At most 200
/// views, evenly chosen.
[[nodiscard]] Value CameraPlots(const CameraRigReport& report, size_t camera);

/// The result in plain text, for the terminal.
[[nodiscard]] std::string CameraText(const CameraRigReport& report);

/// The worst of all findings.
[[nodiscard]] Verdict VerdictOf(const CameraRigReport& report);

}  // namespace calibrato
