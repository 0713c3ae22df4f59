#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/diagnosis/camera_imu_diagnosis.h"
#include "calibrato/diagnosis/finding.h"

namespace calibrato {

/// A camera-IMU calibration with all that is said about it.
struct CameraImuReport {
  CameraImuProblem problem;
  CameraImuCalibration calibration;
  CameraImuDiagnosis diagnosis;
  std::vector<Finding> findings;  ///< On the recording (stream_check.h).
  /// Of the cameras' images, for the prediction error; may be empty, which leaves it out.
  std::vector<Resolution> resolutions = {};
};

/// All findings, the worst first.
[[nodiscard]] std::vector<Finding> FindingsOf(const CameraImuReport& report);
/// The worst of them.
[[nodiscard]] Verdict VerdictOf(const CameraImuReport& report);

/// result.json of `calibrate camera-imu` (docs/formats.md section 3):
///     {"kind": "camera-imu", "termination", "verdict", "findings",
///      "cameras": [{"T_cam_imu": 4x4, "time_offset_s", "rotation_sigma_rad": [3],
///                   "translation_sigma_m": [3], "time_offset_sigma_s",
///                   "verdicts": {"rotation": [3], "translation": [3], "time_offset"},
///                   "line_delay_s", "line_delay_sigma_s", with --line-delay,
///                   "split": {"difference_rad_m_s": [7], "sigma_rad_m_s": [7], "probability"},
///                   "reprojection_rms_px", "num_views", "num_corners", "num_outliers",
///                   "rejected_views": [names], "rejected_view_stamps_ns", "rejected_view_times_s",
///                   "prediction_error_px": expected by the covariance, null without one}],
///      "imus": [{"model", "gyro_bias": [3], "accel_bias": [3], means over time,
///                "gyro_bias_sigma": [3], "accel_bias_sigma": [3], with a covariance,
///                "gyro": {"rms", "normalised", "num_samples", "num_outliers",
///                         "outlier_stamps_ns": [as in the recording],
///                         "outlier_times_s": [from the trajectory's beginning]}, "accel":
///                         likewise,
///                "noise": {"gyro_noise_density", "accel_noise_density"}, "stated_noise": likewise,
///                "T_i_imu": 4x4, "time_offset_s"}],
///      "gravity_g": [3], "knot_spacing_s", "num_iterations",
///      "change_with_finer_knots": in sigmas, null if it was not looked for,
///      "scatter": {"num_parts", "ratio", "probability", "sigma_scale"}, null if a part does not
///                 determine the result; all sigmas and the covariance are scaled by sigma_scale,
///                 the information is not,
///      "imu_models": {"simple", "richer", "used", "squared_residuals_fall", "degrees",
///                     "probability", "qaic_change", "change_rad_m": [[6] of each camera]}, null if
///                     the motion can't tell,
///      "covariance": {"names", "matrix"}, of the calibration, then of the mean biases,
///      "information": {"a_optimality", "d_optimality", "e_optimality", "eigenvalues",
///                      "a_optimality_conditional"},
///      "residuals": {"reprojection_rms_px", "reprojection_rms_all_px", "corner_noise_px",
///                    "reprojection_normalised", "gyro_rms_rad_s", "gyro_normalised",
///                    "accel_rms_m_s2", "accel_normalised"} of camera 0 and IMU 0}
/// Sigmas are null where a parameter is not observable. Without an estimate only the first four
/// keys stand.
[[nodiscard]] Value CameraImuResult(const CameraImuReport& report);

/// The result in plain text, for the terminal.
[[nodiscard]] std::string CameraImuText(const CameraImuReport& report);

}  // namespace calibrato
