#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/calibration/camera_imu_linearisation.h"
#include "calibrato/calibration/camera_imu_measurements.h"
#include "calibrato/calibration/camera_imu_problem.h"
#include "calibrato/calibration/camera_imu_start.h"
#include "calibrato/calibration/camera_imu_state.h"
#include "calibrato/calibration/information.h"
#include "calibrato/calibration/termination.h"

namespace calibrato {

/// What a recording tells of the calibration, all else (trajectory, biases) being unknown.
struct CameraImuInformation {
  std::vector<std::string> names;      ///< CameraImuLayout::names, of rows and columns.
  Eigen::MatrixXd information_matrix;  ///< Marginal.
  Eigen::MatrixXd covariance;          ///< Its inverse; empty where a direction is undetermined.
  /// Of rotation and translation of camera 0's T_c_i, normalised (docs/formats.md section 2), where
  /// the covariance exists.
  Information extrinsics;
  /// The trace of the inverse of that block's own 6 x 6 part of the normal equations, unnormalised:
  /// what the paper's code called information. It takes all else as known.
  double a_optimality_conditional = 0.0;
};

struct CameraImuCalibration {
  Termination termination = Termination::kNoStart;
  std::optional<CameraImuState> state;       ///< None without start values ...
  std::optional<CameraImuNoStart> no_start;  ///< ... and then why, with kNoStart.
  int num_iterations = 0;
  double knot_spacing_s = 0.0;
  /// With check_knot_spacing, where both solves converge: the largest change of an entry of the
  /// calibration when knots are twice as dense, in its standard deviations. Above about 0.5 the
  /// spacing was too coarse for the motion, or the motion too fast for the IMU's rate.
  std::optional<double> change_with_finer_knots;
  CameraImuInformation information;
  CameraImuWeights weights;    ///< Noise as given or estimated.
  CameraImuSelection inliers;  ///< False for outliers and for what lies outside the trajectory.
  CameraImuResiduals residuals;
  int num_corners = 0;                   ///< Inliers.
  double reprojection_rms_px = 0.0;      ///< sqrt(sum(du^2 + dv^2) / N) over inliers.
  double reprojection_rms_all_px = 0.0;  ///< Over all corners on the trajectory that project.
  int num_outside = 0;  ///< Views and samples beyond the trajectory's ends: they play no part.
};

/// Calibrates from nothing but the measurements: start values, Levenberg-Marquardt on the arrowhead
/// system, outliers, noise, covariance.
/// @throws InputError if a camera has no views or an IMU no samples.
[[nodiscard]] CameraImuCalibration CalibrateCameraImu(const CameraImuProblem& problem,
                                                      const CameraImuOptions& options = {});

/// The information at a given state, without a solve: one linearisation, one factorisation. For
/// planners, whose state comes from the motion they consider (StateAlong).
/// @pre problem.corner_noise_px is given
[[nodiscard]] CameraImuInformation InformationAt(const CameraImuProblem& problem,
                                                 const CameraImuState& state);

}  // namespace calibrato
