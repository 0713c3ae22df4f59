#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {

/// What a calibration found of a rig, for programs that use it: of cameras alone, or of cameras
/// with an IMU.
struct RigCalibration {
  /// With an IMU.
  struct CameraOnImu {
    Rigid3 T_c_i;                ///< Kalibr's T_cam_imu.
    double time_offset_s = 0.0;  ///< t_i = t_c + time_offset
    double line_delay_s = 0.0;   ///< Of a rolling shutter, from one row to the next; 0 if none.
  };
  std::vector<Camera> cameras;                           ///< At least one.
  std::vector<CameraOnImu> on_imu;                       ///< One a camera; empty without an IMU.
  std::optional<Imu> imu;                                ///< IMU 0.
  size_t num_imus = 0;                                   ///< That were calibrated.
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();   ///< Mean over the recording [rad/s].
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  ///< [m/s^2]
  double gravity = kStandardGravity;                     ///< Its magnitude [m/s^2].

  /// T_c0_cn of each camera, by way of the IMU where there is one; nothing where a camera is not
  /// related to the first.
  [[nodiscard]] std::vector<std::optional<Rigid3>> PosesInFirst() const;
};

/// @param result  result.json of `calibrate camera` or `calibrate camera-imu`.
/// @param chain   camchain.yaml, or camchain-imucam.yaml, of the same folder.
/// @param imus    imu.yaml of the same folder; null for cameras alone.
/// @throws InputError with file, line and key.
[[nodiscard]] RigCalibration RigCalibrationFromValues(const Value& result, const Value& chain,
                                                      const Value* imus);

}  // namespace calibrato
