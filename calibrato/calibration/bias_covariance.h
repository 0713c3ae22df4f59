#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrato/calibration/camera_imu_calibration.h"

namespace calibrato {

/// A covariance with the names of its rows and columns.
struct NamedCovariance {
  std::vector<std::string> names;
  Eigen::MatrixXd matrix;
};

/// The marginal covariance of a result's calibration (CameraImuInformation::names) and, behind it,
/// of each IMU's biases, as means over the trajectory (MeanBias): "imu0.gyro_bias_x" [rad/s], ..,
/// "imu0.accel_bias_z" [m/s^2]. Biases are of the blocks: it takes one more linearisation and
/// factorisation than the calibration's own.
/// @return empty where the recording leaves something undetermined.
/// @pre the calibration has a state
[[nodiscard]] NamedCovariance CovarianceWithBiases(const CameraImuProblem& problem,
                                                   const CameraImuCalibration& calibration);

}  // namespace calibrato
