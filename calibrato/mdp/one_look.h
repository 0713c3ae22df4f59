#pragma once

#include <optional>

#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"
#include "calibrato/sensors/rig.h"

// Where the board stands, from one image of it: all that a motion is planned relative to.

namespace calibrato {

struct OneLook {
  Rigid3 T_c0_g;
  int num_corners = 0;
  double reprojection_rms_px = 0.0;
  /// Root sums of squares of the standard deviations at the image noise that the residuals show. A
  /// camera that is not as stated shifts the pose besides: a focal length that is 5 % too large
  /// puts the board 5 % too far away.
  double rotation_sigma_rad = 0.0;
  double translation_sigma_m = 0.0;
};

/// Of the two poses that a small plane may have, the one that fits better.
/// @return  Nothing where the corners do not tell a pose: fewer than four of them, or on one line,
/// or where the camera's model does not reach.
[[nodiscard]] std::optional<OneLook> LookAtBoard(const CameraModel& model, const BoardView& view);

/// The rig with its board where camera 0 saw it.
/// @param T_b_e  Where the controlled frame was when the image was taken.
[[nodiscard]] Rig WithBoardAsSeen(Rig rig, const Rigid3& T_b_e, const Rigid3& T_c0_g);

}  // namespace calibrato
