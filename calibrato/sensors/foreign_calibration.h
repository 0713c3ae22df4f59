#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/sensors/rig_calibration.h"

// A calibration as other programs read it. What each of them means by its keys, with sources,
// stands in docs/exports.md; here each foreign convention is met in one function, and nowhere else.
//
// To add a program:
//   1. name it in `CalibrationFormat`, and in the table of foreign_calibration.cc;
//   2. write its function in a file of its own, NAME_files.cc;
//   3. read its output back in tests/exported_calibrations_test.cc by a parser that is not ours,
//   and
//      project points by that program's own formulas;
//   4. say in docs/exports.md what its keys mean, and where that is written.

namespace calibrato {

/// "openvins", "vins-fusion", "basalt", "orb-slam3", "ros".
enum class CalibrationFormat { kOpenVins, kVinsFusion, kBasalt, kOrbSlam3, kRos };
[[nodiscard]] std::optional<CalibrationFormat> FindCalibrationFormat(const std::string& name);
[[nodiscard]] std::vector<std::string> CalibrationFormatNames();

struct ForeignFiles {
  std::map<std::string, std::string> content;  ///< By name within one folder.
  /// What the program has no place for, and what to do about it; one sentence each.
  std::vector<std::string> warnings;
};

/// @param camera_rate_hz  Images a second, > 0; only ORB-SLAM3 asks for it.
/// @throws InputError where the program knows no such lens or IMU model, cannot do without an IMU,
/// or is not told the camera's rate.
[[nodiscard]] ForeignFiles FilesFor(CalibrationFormat format, const RigCalibration& rig,
                                    std::optional<double> camera_rate_hz);

// One function a program.
[[nodiscard]] ForeignFiles OpenVinsFiles(const RigCalibration& rig);
[[nodiscard]] ForeignFiles VinsFusionFiles(const RigCalibration& rig);
[[nodiscard]] ForeignFiles BasaltFiles(const RigCalibration& rig);
[[nodiscard]] ForeignFiles OrbSlam3Files(const RigCalibration& rig,
                                         std::optional<double> camera_rate_hz);
[[nodiscard]] ForeignFiles RosFiles(const RigCalibration& rig);

// What several of them share.

/// @throws InputError that names the lens's model and those that the program knows.
[[noreturn]] void RefuseLens(const Camera& camera, const std::string& program,
                             const std::string& known);
/// @throws InputError if there is no IMU.
void RequireImu(const RigCalibration& rig, const std::string& program);
/// @throws InputError if the IMU's model has scale or misalignment, which the program has no place
/// for.
void RequirePlainImu(const RigCalibration& rig, const std::string& program);
/// Warnings on what hardly any program has a place for: rolling shutters, further IMUs, and (where
/// the program has one time offset for all) cameras with different ones.
void WarnOfWhatIsLeftOut(const RigCalibration& rig, const std::string& program,
                         bool one_time_offset, std::vector<std::string>* warnings);

/// fu fv pu pv k1 k2 p1 p2 of pinhole-none (zeros) and pinhole-radtan; nothing for other lenses.
[[nodiscard]] std::optional<std::array<double, 8>> AsPinholeRadtan(const CameraModel& model);

}  // namespace calibrato
