#pragma once

#include <optional>
#include <vector>

#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// Another lens of the same model that sees the image nearly as `lens` does: `start` adjusted to
/// its rays through a grid of pixels, up to a motion of the camera, which board poses would make up
/// for. Models with parameters of shape (double spheres, omni with distortion) have such twins,
/// each near a minimum of its own of a calibration. Nothing where `start` ends at `lens` again, or
/// sees half of the rays not at all.
/// @param fixed  Parameters that keep their value in `start`; empty for none.
[[nodiscard]] std::optional<CameraModel> FindLensTwin(const CameraModel& lens,
                                                      Resolution resolution,
                                                      const CameraModel& start,
                                                      const std::vector<bool>& fixed);

/// Pixels per radian in the middle of the image [px].
[[nodiscard]] double CentralFocalLength(const CameraModel& lens);

}  // namespace calibrato
