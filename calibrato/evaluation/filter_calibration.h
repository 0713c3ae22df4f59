#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// What a filter is told before it starts.
struct FilterProblem {
  CameraModel camera;
  std::vector<BoardView> views;  ///< In order of time; the rig is at rest at the first of them.
  ImuStream imu;                 ///< Both sensors with the same stamps, on the camera's clock.
  ImuNoise noise;
  double corner_noise_px = 0.1;
  Rigid3 T_c_i_guess;                     ///< As a tape measure has it, ...
  double guess_rotation_sigma = 0.1;      ///< ... to so much [rad] ...
  double guess_translation_sigma = 0.03;  ///< ... and so much [m].
};

struct FilterCalibration {
  Rigid3 T_c_i;
  /// Of [rotation, translation], as the filter believes.
  Eigen::Matrix<double, 6, 6> covariance;
};

/// Camera-IMU calibration by an iterated extended Kalman filter: the alternative that the paper
/// cites. One pass over the recording, image by image; what was linearised stays so.
///
/// State: pose of the IMU before the board, its velocity, biases, gravity in the board's frame, and
/// T_c_i, with errors in the order [rotation, position, velocity, gyroscope bias, accelerometer
/// bias, gravity, rotation and translation of T_c_i]. The IMU drives it from image to image; each
/// image's corners correct it.
///
/// After Mirzaei and Roumeliotis, "A Kalman filter-based algorithm for IMU-camera calibration",
/// IEEE Transactions on Robotics 2008. Theirs takes the board as level; here gravity is estimated,
/// from where it is found at rest, and errors of velocity and gravity turn with the attitude's. As
/// theirs it knows no time offset.
/// @return nothing without a first pose, without IMU samples, or if the filter diverges (an
/// estimate that is not finite, or puts the board behind the camera).
[[nodiscard]] std::optional<FilterCalibration> CalibrateByFilter(const FilterProblem& problem);

}  // namespace calibrato
