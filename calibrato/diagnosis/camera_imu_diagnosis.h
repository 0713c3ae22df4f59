#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/calibration/bias_covariance.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/diagnosis/camera_imu_parts.h"
#include "calibrato/diagnosis/camera_imu_residuals.h"
#include "calibrato/diagnosis/finding.h"
#include "calibrato/diagnosis/imu_model_comparison.h"

namespace calibrato {

/// Whether one number of the result may be believed.
struct ParameterVerdict {
  std::string name;    ///< "cam0.rot_x", "cam0.pos_x", "cam0.time_offset"
  double sigma = 0.0;  ///< [rad], [m] or [s], scaled by the scatter; NaN where not observable.
  Verdict verdict = Verdict::kPass;
};

/// What is wrong with a camera-IMU calibration, and what it was judged by.
struct CameraImuDiagnosis {
  std::vector<Finding> findings;  ///< The worst first.
  /// Of each camera: rotation about and translation along x, y, z of the camera, then the time
  /// offset where it was estimated. Empty without a state.
  std::vector<ParameterVerdict> parameters;
  std::optional<CameraImuResidualSummary> residuals;  ///< Where there is a state.
  /// How far quarters of the recording lie apart, where each determines the result.
  std::optional<CameraImuScatter> scatter;
  std::optional<CameraImuSplit> split;
  /// Where the motion tells the models apart.
  std::optional<ImuModelComparison> imu_models;
  /// Of the calibration and the IMUs' mean biases; not scaled; empty without one.
  NamedCovariance covariance;
  std::vector<CameraImuKnowledge> knowledge;  ///< Over time; empty without a state.

  /// By which all stated standard deviations were multiplied.
  [[nodiscard]] double sigma_scale() const { return scatter ? scatter->sigma_scale() : 1.0; }
};

/// Thresholds: docs/formats.md section 1.
/// - fail, of all parameters: not converged, an IMU's residuals over three times its stated noise;
/// - inconclusive, of one: sigma above 1 degree, 20 mm or 5 ms, or not observable; the finding says
///   about which axes to rotate faster;
/// - warn, of one: sigma above 0.2 degrees, 5 mm or 0.5 ms, or halves of the recording that
///   disagree by more than three sigmas; of all: IMUs that are not as their model has them, where
///   that moves the result by more than three sigmas;
/// - info: noise that is not as stated, parts of the recording that scatter, outliers left out,
///   measurements that play no part.
/// All standard deviations are scaled by the scatter of the recording's parts.
[[nodiscard]] CameraImuDiagnosis DiagnoseCameraImu(const CameraImuProblem& problem,
                                                   const CameraImuCalibration& calibration);

}  // namespace calibrato
