#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/geometry/pose_spline.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/imu.h"

namespace calibrato {

/// Biases of an IMU at one knot; linear in time between knots.
struct ImuBias {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// What is estimated of a camera.
struct CameraCalibrationState {
  CameraModel model;
  Rigid3 T_c_i;                ///< Kalibr's T_cam_imu.
  double time_offset_s = 0.0;  ///< t_i = t_c + time_offset [s]
  /// Of a rolling shutter: a corner in row v was exposed this times v after the stamp [s]. Rows are
  /// read upwards where it is negative.
  double line_delay_s = 0.0;
};

/// What is estimated of an IMU.
struct ImuCalibrationState {
  ImuIntrinsics intrinsics;
  Rigid3 T_i_imu;               ///< From this IMU's frame to that of IMU 0; identity for IMU 0.
  double time_offset_s = 0.0;   ///< t_0 = t_imu + time_offset [s]; 0 for IMU 0.
  std::vector<ImuBias> biases;  ///< At knots that are `block_duration_s` apart, from time 0 on.
};

/// Over time: of all knots alike.
[[nodiscard]] ImuBias MeanBias(const ImuCalibrationState& imu);

/// All unknowns of a camera-IMU problem.
struct CameraImuState {
  Time start;                 ///< Of the spline: its time 0, on the clock of IMU 0.
  PoseSpline T_g_i;           ///< The trajectory.
  Eigen::Vector3d gravity_g;  ///< [m/s^2], of fixed length.
  std::vector<CameraCalibrationState> cameras;
  std::vector<ImuCalibrationState> imus;
  /// True size of the board over the one that the target states; T_g_i is in true metres.
  double board_scale = 1.0;

  /// Bias knots are this far apart: (order - 1) spacings of the trajectory's knots.
  double block_duration_s() const { return (T_g_i.order() - 1) * T_g_i.spacing_s(); }
  int num_blocks() const { return T_g_i.num_control_points() / (T_g_i.order() - 1); }
  /// Bias of an IMU at a time of the spline.
  ImuBias BiasAt(int imu, double t_s) const;
};

/// The state of a rig whose motion is known, with biases of zero: where planners linearise.
/// @param pose_g_i  T_g_i at times from somewhat before 0 to somewhat after duration_s.
/// @param knot_spacing_s  Reduced a little, so that whole blocks cover the duration.
[[nodiscard]] CameraImuState StateAlong(const std::function<Rigid3(double t_s)>& pose_g_i,
                                        Time start, double duration_s, double knot_spacing_s,
                                        int spline_order, const Eigen::Vector3d& gravity_g,
                                        std::vector<CameraCalibrationState> cameras,
                                        size_t num_imus);

/// What earlier recordings of the same rig before the same board say of the calibration: their
/// estimate, and their marginal information about it in the columns of CameraImuLayout. Added to a
/// new recording it stands for them, as if all had been solved together, to first order around
/// their estimate, at the cost of the new one alone.
struct CalibrationPrior {
  CameraImuState estimate;  ///< Of it, the calibration counts: not trajectory and biases.
  Eigen::MatrixXd information_matrix;
};

}  // namespace calibrato
