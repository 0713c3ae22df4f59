#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/evaluation/chart.h"
#include "calibrato/evaluation/contest.h"
#include "calibrato/evaluation/contestant.h"

namespace calibrato {

/// What the estimator says of one recording.
struct EstimatorOutput {
  std::string policy;
  size_t member = 1;  ///< Of the motions of that name, the first is 1.
  CameraImuCalibration calibration;
  std::vector<double> gyro_time_s;   ///< Of the residuals, since the trajectory's beginning.
  std::vector<double> accel_time_s;  ///< Likewise.
  Eigen::Vector3d true_gyro_bias = Eigen::Vector3d::Zero();   ///< Mean over the recording.
  Eigen::Vector3d true_accel_bias = Eigen::Vector3d::Zero();  ///< Likewise.
};

/// The paper's Figure 7: residuals, biases and reprojection errors of the estimator, for one
/// recording of the scene's rig by `handcrafted` and by each motion that was brought for the
/// extrinsic task.
struct Figure7 {
  ContestSetting setting;
  std::vector<EstimatorOutput> outputs;
};
/// @throws InputError for fidelity `rendered`.
[[nodiscard]] Figure7 EvaluateFigure7(const ContestSetting& setting,
                                      const std::vector<MotionUnderTrial>& motions);

/// {"kind": "figure7", "rows": [..]}: for each motion "policy", "member", "termination",
/// "reprojection_rms_px", "reprojection_mean_px" [u, v], "reprojection_skewness" [u, v],
/// "gyro_rms_rad_s", "accel_rms_m_s2", each "_normalised" too, and "gyro_bias_error_rad_s",
/// "accel_bias_error_m_s2" of the mean biases.
[[nodiscard]] Value ToValue(const Figure7& figure);
[[nodiscard]] std::vector<Chart> ChartsOf(const Figure7& figure);

}  // namespace calibrato
