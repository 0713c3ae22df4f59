#pragma once

#include "calibrato/base/value.h"
#include "calibrato/diagnosis/camera_imu_document.h"

namespace calibrato {

/// What the report draws of a camera-IMU calibration. Times are seconds from the trajectory's
/// beginning; an `envelope` is {"time_s", "low", "high"} (envelope.h), three of them an axis each.
///
///     {"duration_s",
///      "imus": [{"gyro": {"measured": [3 envelopes], "predicted": [3], "residual": [3],
///                         "stddev", "outliers": [[time_s, x, y, z]..] at most 500,
///                         "interval_ms": envelope, "median_interval_ms"},
///                "accel": likewise,
///                "bias_time_s": [..], "gyro_bias": [[x, y, z]..], "accel_bias": [[x, y, z]..],
///                "gyro_walk", "accel_walk": the stated random walks, a root of a second}],
///      "cameras": [{"rms": envelope of the views' reprojection error [px],
///                   "corner_residuals": [[time_s, du, dv]..] at most 1500 inliers,
///                   "interval_ms": envelope, "median_interval_ms"}],
///      "corner_noise_px",
///      "trajectory_g": [[x, y, z]..] of IMU 0 [m], "axis_g": [[x, y, z, dx, dy, dz]..] of camera
///      0, "board_outline_g": [[x, y, z] four times], "knowledge": {"time_s", "rotation_sigma_rad",
///      "translation_sigma_m",
///                    "time_offset_sigma_s"}}
///
/// An empty object without an estimate.
[[nodiscard]] Value CameraImuPlots(const CameraImuReport& report);

}  // namespace calibrato
