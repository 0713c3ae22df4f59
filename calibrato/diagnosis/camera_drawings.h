#pragma once

#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/calibration/rejection.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

// Members of a camera's "plots" (report/report.h) that are computed for the eye alone.

namespace calibrato {

/// How far the lens moves a point, from the image's middle to its corner, beside a pinhole of the
/// focal length [px/rad] that the lens has in its middle (with xi, fu is another): {"radius_px":
/// [..], "shift_px": [..]}, the pinhole's distance from the principal point and how much farther
/// out the lens sees the same direction. It ends where the lens sees no more.
[[nodiscard]] Value DistortionCurve(const CameraModel& model, Resolution resolution);

/// {"angle_rad": [..], "radius_px": [..]}: where a direction is seen, by its angle off the optical
/// axis; from the principal point towards the image corner that is farthest from it, as far as
/// pixels have rays.
[[nodiscard]] Value LensCurve(const CameraModel& model, Resolution resolution);

/// {"name", "pixels": [[u, v]..], "straightened": [[u, v]..], "lines": [[indices]..]}: the view in
/// which the board is largest, as it was seen and as a lens without distortion that looks at the
/// board's middle would see it, at the same place and size. Lines are the board's rows and columns.
/// Null without views.
[[nodiscard]] Value StraightenedView(const CameraModel& model, const std::vector<BoardView>& views);

/// [{"view", "pixel": [u, v], "residual": [du, dv]}..] of the first 1000.
[[nodiscard]] Value RejectedCornerMarks(const std::vector<RejectedCorner>& corners);

}  // namespace calibrato
