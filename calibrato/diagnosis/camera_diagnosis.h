#pragma once

#include <optional>
#include <vector>

#include "calibrato/calibration/board_shape.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/diagnosis/finding.h"
#include "calibrato/diagnosis/residual_field.h"
#include "calibrato/diagnosis/split_check.h"

namespace calibrato {

/// What is wrong with a camera calibration, and what it was judged by.
struct CameraDiagnosis {
  std::vector<Finding> findings;  ///< The worst first.
  std::optional<SplitCheck> split;
  std::optional<ResidualField> residual_field;
  std::optional<BoardShape> board_shape;
};

/// Thresholds: docs/formats.md section 1; what is measured and how: docs/camera-diagnosis.md.
/// - fail: not converged, rank-deficient, sigma(f) / f above 1 %, fewer than 3 views;
/// - warn: a coverage range not reached, halves of the views that disagree or predict each other
///   badly, a board that is bent or not as stated, a lens that the model does not fit;
/// - info: parts of the image never covered, one distance only, blurred views, what was left out.
[[nodiscard]] CameraDiagnosis DiagnoseCamera(const CameraProblem& problem,
                                             const CameraCalibration& calibration);

}  // namespace calibrato
