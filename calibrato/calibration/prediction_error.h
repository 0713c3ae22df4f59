#pragma once

#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// prediction_error_px where the extrinsics are exact: the root mean square, over a grid of 16 x 12
/// pixels of the image, of the distance between where the true camera and where the estimated one
/// sees the same direction [px]. A direction that the estimate can't project counts as one image
/// diagonal.
[[nodiscard]] double PredictionErrorPx(const CameraModel& estimate, const CameraModel& truth,
                                       Resolution resolution);

}  // namespace calibrato
