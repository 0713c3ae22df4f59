#pragma once

#include <string>
#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/base/value.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/imu.h"

namespace calibrato {

/// One IMU of a rig, as in an entry of Kalibr's imu.yaml.
struct Imu {
  ImuNoise noise;
  ImuModelKind model = ImuModelKind::kCalibrated;
  ImuIntrinsics intrinsics;
  Rigid3 T_i_b;          ///< From the first IMU's frame, Kalibr's b; identity for the first.
  Duration time_offset;  ///< t_first = t_this + time_offset; 0 for the first.
  std::string rostopic = "/imu0";  ///< Where its samples are in a bag.
};

/// "calibrated", "scale-misalignment", "scale-misalignment-size-effect", as Kalibr's --imu-models.
[[nodiscard]] std::string ImuModelName(ImuModelKind model);
[[nodiscard]] ImuModelKind ImuModelFromName(const std::string& name);  ///< @throws InputError

/// Kalibr's imu.yaml in both of its forms: what is given to it, the noise of one IMU alone, and
/// what it writes, entries imu0, imu1, .. with model, T_i_b, time_offset and, where the model has
/// them,
///
///     accelerometers: {M: 3x3, rx_i: [3], ry_i: [3], rz_i: [3]}
///     gyroscopes: {M: 3x3, A: 3x3, C_gyro_i: 3x3}
///
/// with M of lower triangles, A the g_sensitivity, C_gyro_i = R_gyro_i and r*_i the lever arms.
/// @throws InputError with line and key. Unknown keys are appended to warnings (may be null).
[[nodiscard]] std::vector<Imu> ImusFromValue(const Value& value,
                                             std::vector<std::string>* warnings);
/// In the form that Kalibr writes.
[[nodiscard]] Value ToValue(const std::vector<Imu>& imus);

/// The five noise keys alone, all positive, in the form that Kalibr is given. Other keys are not
/// looked at. @throws InputError
[[nodiscard]] ImuNoise ImuNoiseFromValue(const Value& value);
[[nodiscard]] Value ToValue(const ImuNoise& noise, const std::string& rostopic = "/imu0");

/// The keys `accelerometers` and `gyroscopes` of an entry, each optional, and so are theirs: what
/// is missing is as in a perfect IMU. @throws InputError
[[nodiscard]] ImuIntrinsics ImuIntrinsicsFromValue(const Value& entry,
                                                   std::vector<std::string>* warnings);
/// Adds those two keys to an entry, as far as the model has them.
void SetImuIntrinsics(const ImuIntrinsics& intrinsics, ImuModelKind model, Value* entry);

}  // namespace calibrato
