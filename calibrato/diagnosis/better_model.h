#pragma once

#include <optional>
#include <string>

#include "calibrato/calibration/camera_calibration.h"

namespace calibrato {

/// A model that fits a lens better than the one it was calibrated with.
struct BetterModel {
  std::string name;
  double noise_stddev_px = 0.0;  ///< That it leaves, of one coordinate [px].
};

/// Calibrates the used views with each of the models that take up where this one ends (more
/// distortion, a wider lens). The one that leaves least noise; nothing where none leaves at least a
/// twentieth less.
[[nodiscard]] std::optional<BetterModel> FindBetterModel(const CameraProblem& problem,
                                                         const CameraCalibration& calibration);

}  // namespace calibrato
