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
  /// Of the fall of the sum of squared residuals that the parameters of kScaleMisalignment bring.
  Significance significance;
  /// By how much they move each camera's T_c_i, in its frame ([dtheta [rad], dt [m]]): from the
  /// result of the simple model to that of the richer one.
  std::vector<Eigen::Vector<double, 6>> change;
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
