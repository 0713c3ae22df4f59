#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/comparison.h"
#include "calibrato/sensors/imu.h"

namespace calibrato {

/// Whether a recording tells IMUs with scale and misalignment (24 further parameters each) from
/// ones that are as their data sheets say.
struct ImuModelComparison {
  /// Of the fall of the sum of squared residuals that the parameters of kScaleMisalignment bring:
  /// twice the logarithm of the likelihoods' ratio.
  Significance significance;
  /// By how much they move each camera's T_c_i, in its frame ([dtheta [rad], dt [m]]): from the
  /// result of the simple model to that of the richer one.
  std::vector<Eigen::Vector<double, 6>> change;
  /// Whether the result is that of the simple model: all IMUs are kCalibrated. With a richer kind
  /// for any of them, it is not.
  bool is_simple_used = false;

  /// Akaike's criterion of the richer model less that of the simple one, for likelihoods whose
  /// squared residuals are divided by the scatter (QAIC; Burnham and Anderson, "Model Selection and
  /// Multimodel Inference", 2002, section 2.5): twice the further parameters, less the fall. Below
  /// zero the richer one predicts better.
  [[nodiscard]] double qaic_change() const {
    return 2.0 * significance.degrees - significance.statistic;
  }
};

/// Without solving again: if all IMUs were calibrated as kCalibrated, by what one Gauss-Newton step
/// with the further parameters promises (Rao's score test); else by what the estimates of those
/// parameters say against the values of a perfect IMU (Wald's test).
/// @param sigma_scale  By which standard deviations are multiplied (CameraImuScatter).
/// @return nothing where the motion does not determine the parameters, or where a prior of the
/// simple model takes part.
[[nodiscard]] std::optional<ImuModelComparison> CompareImuModels(
    const CameraImuProblem& problem, const CameraImuCalibration& calibration, double sigma_scale);

}  // namespace calibrato
