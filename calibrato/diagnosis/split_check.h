#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/comparison.h"

namespace calibrato {

/// What the two halves of a calibration's views say of each other. The views are dealt out in runs
/// of neighbours, so that the errors which neighbouring images of a video share do not stand on
/// both sides.
struct SplitCheck {
  std::array<Eigen::VectorXd, 2> parameters;  ///< As each half alone finds them.
  Eigen::VectorXd sigma;                      ///< Of their difference; 0 for held parameters.
  Significance significance;                  ///< Of the difference of all parameters.

  /// Noise of one coordinate [px]: of the views by which a half was fitted ...
  double in_sample_stddev_px = 0.0;
  /// ... and of the other half's views, predicted by it (only their poses are fitted) ...
  double held_out_stddev_px = 0.0;
  /// ... and what it should be, given how well half the views determine the camera.
  double expected_held_out_stddev_px = 0.0;
  int degrees = 0;  ///< Degrees of freedom of the in-sample residuals of both halves.
};

/// Nothing without a covariance, or where a half does not determine the camera.
/// @param fixed  The problem's.
[[nodiscard]] std::optional<SplitCheck> CheckSplit(const CameraCalibration& calibration,
                                                   const std::vector<bool>& fixed);

}  // namespace calibrato
