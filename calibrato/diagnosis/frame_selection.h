#pragma once

#include <string>
#include <vector>

#include "calibrato/calibration/camera_rig_calibration.h"
#include "calibrato/diagnosis/finding.h"

namespace calibrato {

/// Which frames of a recording are used: `--select`.
enum class FrameSelection {
  kAll,
  kDistinct,    ///< Without those that repeat another (calibration/view_selection.h).
  kCoverage,    ///< New views of a slow board, as in the paper (calibration/view_selection.h).
  kInformation  ///< Those that add information, until more would not help.
};

/// "all", "distinct", "coverage", "information". @throws InputError for another name.
[[nodiscard]] FrameSelection FrameSelectionFromName(const std::string& name);

/// Leaves the frames that are not selected out of the problem; a frame that one camera wants is
/// kept for all of them. Selection by information calibrates each camera with all of its views
/// first, and leaves a camera alone that can't be calibrated.
/// @return how many were kept, and how much of the recording would have been enough; where all are
///         used, which cameras have many views that repeat another.
[[nodiscard]] std::vector<Finding> SelectFrames(FrameSelection selection,
                                                CameraRigProblem* problem);

}  // namespace calibrato
