#pragma once

#include <Eigen/Core>

#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/camera_imu_state.h"
#include "calibrato/sensors/camera_model.h"

// prediction_error_px (docs/formats.md section 2): one number for what a calibration is worth to
// whoever predicts pixels from it, such as a visual-inertial filter. The rig turns at 1 rad/s about
// the IMU, and a point is known exactly in the IMU's frame; how far from its image does the
// calibration place it? Root mean square over
//
// - a grid of 16 x 12 pixels of the image,
// - points at 0.5 m and 2 m from the camera along each pixel's ray, and at infinity,
// - all directions of the angular velocity.
//
// An error of the time offset, d, moves the point in the IMU's frame by d (omega x p_i), so that it
// counts as much as a turn by d radians.

namespace calibrato {

/// Of the lens alone, as if extrinsics and time offset were exact: how far from its image the
/// estimate places a direction [px], root mean square over the grid. One that the estimate can't
/// project counts as one image diagonal; pixels of which the true lens sees nothing do not count,
/// and if none is left the result is NaN.
[[nodiscard]] double PredictionErrorPx(const CameraModel& estimate, const CameraModel& truth,
                                       Resolution resolution);

/// Of a camera with its extrinsics, time offset and line delay, where the truth is known [px].
/// Points that the estimate can't project count as one image diagonal; as above, pixels of which
/// the true lens sees nothing do not count, and if none is left the result is NaN.
[[nodiscard]] double PredictionErrorPx(const CameraCalibrationState& estimate,
                                       const CameraCalibrationState& truth, Resolution resolution);

/// What it is to be expected to be, the root of its mean square, where the truth is not known: by
/// propagating the covariance to first order [px]. What was held counts as exact: with all held it
/// is 0. Points that the camera does not project are left out; if none is left the result is NaN.
/// @param columns  Where the camera's parameters stand in the covariance.
[[nodiscard]] double ExpectedPredictionErrorPx(const CameraCalibrationState& camera,
                                               Resolution resolution,
                                               const CameraImuLayout::Camera& columns,
                                               const Eigen::MatrixXd& covariance);

}  // namespace calibrato
