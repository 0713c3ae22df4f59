#pragma once

#include <optional>
#include <vector>

#include "calibrato/calibration/board_bending.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/comparison.h"

// Is the board what its target file says? A calibration that took it for flat and true leaves
// residuals that tell. One Gauss-Newton step from that calibration, with the shape as further
// unknowns beside poses and camera, is enough: boards are wrong by little. The statistic is by how
// much the step lowers the squared error, over the noise that is then left (score test).

namespace calibrato {

/// How the board stands out of its plane.
struct BoardBendingEstimate {
  BoardBending bending;
  double depth_m = 0.0;  ///< Lowest to highest point [m].
  Significance significance;
};

/// How its corners are placed wrongly in the plane. Its size cannot be seen: it scales the poses.
struct BoardStretchEstimate {
  double stretch =
      0.0;  ///< Distances along y are 1 + stretch times what is stated, beside those along x.
  double shear = 0.0;  ///< By how much the angle between the axes is less than a right one [rad].
  double stretch_sigma = 0.0;
  double shear_sigma = 0.0;  ///< [rad]
  Significance significance;
};

struct BoardShape {
  BoardBendingEstimate bending;
  /// Nothing where the views do not determine it: all at one roll angle they leave it to fu / fv.
  std::optional<BoardStretchEstimate> stretch;
  double noise_stddev_px = 0.0;  ///< Of one coordinate, that such a board would leave [px].
};

/// Bending and stretch together, so that neither is taken for the other. Nothing without a
/// covariance, or where the views do not determine the bending.
/// @param fixed  The problem's.
[[nodiscard]] std::optional<BoardShape> EstimateBoardShape(const CameraCalibration& calibration,
                                                           const std::vector<bool>& fixed);

}  // namespace calibrato
