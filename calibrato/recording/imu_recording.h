#pragma once

#include <string>
#include <vector>

#include "calibrato/sensors/imu.h"

namespace calibrato {

/// What one IMU recorded, as its files have it (recording/imu_list.h).
struct ImuRecording {
  std::string name;  ///< "imu0"
  ImuStream stream;
};

/// The IMUs of a recording's folder: imu0, imu1, .., each as imu0.csv, imu0/data.csv (EuRoC), or
/// gyro0.csv with accel0.csv for sensors of different rates, each plain or with .gz behind it. None
/// is a recording of cameras alone.
/// @throws InputError: an IMU in two forms, a gyroscope without its accelerometer, an IMU missing
/// in between; and all that the lists throw.
[[nodiscard]] std::vector<ImuRecording> OpenImuRecordings(const std::string& folder);

}  // namespace calibrato
