#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/calibration/camera_imu_state.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// How well a camera's parameters are known before the recording is looked at.
enum class IntrinsicsKnowledge {
  kExact,    ///< They are held.
  kPrior,    ///< Known with a covariance, as from a camera calibration: estimated with it.
  kUnknown,  ///< Estimated from this recording alone; the model is where to start.
};

/// One camera of the rig and what it saw.
struct CameraImuCamera {
  CameraModel model;
  std::vector<BoardView> views;  ///< In order of time, on the camera's clock.
  IntrinsicsKnowledge intrinsics = IntrinsicsKnowledge::kExact;
  /// With kPrior: of all parameters; zero rows and columns for those that were held.
  Eigen::MatrixXd intrinsics_covariance;
};

/// One IMU of the rig and what it recorded.
struct CameraImuImu {
  ImuStream stream;  ///< Each sensor's stamps ascending; values finite.
  ImuNoise noise;
  ImuModelKind model = ImuModelKind::kCalibrated;
};

/// Cameras and IMUs on one rigid body, moved before a board at rest. Frame g, the board's, is the
/// world of the estimator; frame i is that of IMU 0.
struct CameraImuProblem {
  std::vector<CameraImuCamera> cameras;  ///< At least one.
  std::vector<CameraImuImu> imus;        ///< At least one.
  double gravity = kStandardGravity;     ///< |g|, held [m/s^2].
  bool estimate_time_offsets = true;     ///< Else held at zero.
  bool estimate_line_delays = false;     ///< Else held at zero: shutters are global.
  /// Else held at 1. The accelerometer tells what the images can't: how long a metre is.
  bool estimate_board_scale = false;
  /// Noise of one coordinate of a corner [px], the same for all cameras. Estimated where not given.
  std::optional<double> corner_noise_px;
  /// Adds to what this recording says, and is where its solve starts from.
  std::optional<CalibrationPrior> prior;
};

struct CameraImuOptions {
  int spline_order = 6;
  /// Of the trajectory's knots [s]; chosen from the data where not given (knot_spacing.h).
  std::optional<double> knot_spacing_s;
  /// Solve once more with half that spacing and report by how much the calibration moves.
  bool check_knot_spacing = false;
  int max_iterations = 100;  ///< Of all rounds together.
  /// Time offsets are looked for within +- this [s].
  double max_time_offset_s = 1.0;
  /// Estimate the noise of gyroscopes and accelerometers too, in place of what their data sheets
  /// say. (That of corners is estimated wherever it is not given; random walks never are.)
  bool estimate_imu_noise = false;
  /// Leave out corners and IMU samples that do not fit the others.
  bool reject_outliers = true;
};

}  // namespace calibrato
