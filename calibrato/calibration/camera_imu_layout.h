#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/calibration/camera_imu_problem.h"
#include "calibrato/calibration/camera_imu_state.h"

namespace calibrato {

/// Where each unknown stands in the arrowhead system. A block holds order - 1 control points
/// ([dtheta, dt] each), then a bias knot of each IMU ([gyro, accel]), so that no measurement sees
/// more than two blocks in a row. The border holds the calibration:
///
///     for each camera:  T_c_i (6), time offset (1), line delay (1), parameters
///     gravity (2): a turn about the two axes of GravityTangent
///     size of the board (1)
///     for each IMU:     T_i_imu (6) and time offset (1), but not of IMU 0; intrinsics
class CameraImuLayout {
 public:
  CameraImuLayout(const CameraImuProblem& problem, int spline_order);

  /// Columns of the border; -1 where an unknown is held.
  struct Camera {
    int pose = 0;
    int time_offset = -1;
    int line_delay = -1;
    int parameters = -1;
  };
  struct Imu {
    int pose = -1;
    int time_offset = -1;
    int intrinsics = -1;
    int num_intrinsics = 0;
  };
  std::vector<Camera> cameras;
  int gravity = 0;
  int board_scale = -1;
  std::vector<Imu> imus;

  int points_per_block = 0;
  int block_size = 0;
  int border_size = 0;
  /// One a column of the border: "cam0.rot_x", .., "cam0.time_offset", "cam0.fu", "gravity_1",
  /// "imu0.M_accel_xx", ..
  std::vector<std::string> names;

  /// Column in two consecutive blocks, of which block c is the first: of a control point's six, and
  /// of an IMU's bias knot (0: at the beginning of block c; 1: at its end).
  int PointColumn(int c, int control_point) const;
  int BiasColumn(int imu, int knot) const;
};

/// Numbers of IMU intrinsics that a model estimates: 0, 24 or 30, in the order M_accel (xx yx yy zx
/// zy zz), M_gyro, R_gyro_i (its perturbation), g_sensitivity row by row, lever arms of y and z.
[[nodiscard]] int NumImuIntrinsics(ImuModelKind kind);

/// Two axes (columns) at right angles to gravity, about which it is turned.
[[nodiscard]] Eigen::Matrix<double, 3, 2> GravityTangent(const Eigen::Vector3d& gravity_g);

/// The state after a step: blocks in order, then the border. Nothing where a camera's parameters
/// leave the model's domain (a focal length below zero), or the board's size does.
[[nodiscard]] std::optional<CameraImuState> Perturbed(const CameraImuState& state,
                                                      const CameraImuLayout& layout,
                                                      const Eigen::VectorXd& delta);

/// The border's part of a step from one state to another: Perturbed(from, ..) by it has the
/// calibration of `to`.
[[nodiscard]] Eigen::VectorXd CalibrationDifference(const CameraImuState& to,
                                                    const CameraImuState& from,
                                                    const CameraImuLayout& layout);

}  // namespace calibrato
