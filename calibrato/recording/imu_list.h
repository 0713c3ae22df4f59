#pragma once

#include <string>
#include <vector>

#include "calibrato/sensors/imu.h"

namespace calibrato {

// Lists of IMU samples (docs/formats.md section 3), plain or gzip, one sample a line:
//
//     #timestamp [ns],w_x [rad/s],w_y [rad/s],w_z [rad/s],a_x [m/s^2],a_y [m/s^2],a_z [m/s^2]
//     1404733405747800064,0.014661,-0.028623,0.125664,9.365351,-0.335061,-3.277056
//
// Columns are matched by their name before the bracket, in any order; others are ignored. A name is
// one of those below with x, y or z, "_" or "." between them or not, in either case:
//     gyroscope      w, w_RS_S (EuRoC), omega (Kalibr), g, gyr, gyro, angular_velocity
//     accelerometer  a, a_RS_S, alpha, f, acc, accel, linear_acceleration
//     stamp          timestamp, stamp, time, t
// Where no column of a sensor is named, or without a header, the order is Kalibr's: the stamp, the
// gyroscope's x y z, the accelerometer's x y z, and nothing else. A unit in brackets must be that
// above (or "rad s^-1", "m s^-2", as EuRoC has them).
//
// Samples are returned as the file has them: neither sorted nor cleared of twins, and "nan" and
// "inf" are kept (diagnosis/stream_check.h).
//
// All throw InputError with file and line: a column missing or twice, another unit, a stamp that is
// no whole number of nanoseconds, a field that is no number, too few or too many fields, no rows,
// more than 50 million; no text, truncated gzip.

/// Both sensors from one list, with the same stamps.
[[nodiscard]] ImuStream ReadImuList(const std::string& path);

/// One sensor from a list of its own: stamp, x, y, z. Columns may be called x, y, z alone.
[[nodiscard]] std::vector<VectorSample> ReadGyroList(const std::string& path);
[[nodiscard]] std::vector<VectorSample> ReadAccelList(const std::string& path);

/// The content of such a list; digits enough to read back the same numbers.
/// @pre Both sensors have the same stamps.
[[nodiscard]] std::string ImuListText(const ImuStream& stream);
[[nodiscard]] std::string GyroListText(const std::vector<VectorSample>& samples);
[[nodiscard]] std::string AccelListText(const std::vector<VectorSample>& samples);

}  // namespace calibrato
