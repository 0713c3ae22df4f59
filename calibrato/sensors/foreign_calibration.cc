#include "calibrato/sensors/foreign_calibration.h"

#include <algorithm>
#include <cmath>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

// In the order of the enum.
const std::vector<std::string> kNames = {"openvins", "vins-fusion", "basalt", "orb-slam3", "ros"};

}  // namespace

std::optional<CalibrationFormat> FindCalibrationFormat(const std::string& name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<CalibrationFormat>(found - kNames.begin());
}

std::vector<std::string> CalibrationFormatNames() { return kNames; }

ForeignFiles FilesFor(CalibrationFormat format, const RigCalibration& rig,
                      std::optional<double> camera_rate_hz) {
  switch (format) {
    case CalibrationFormat::kOpenVins:
      return OpenVinsFiles(rig);
    case CalibrationFormat::kVinsFusion:
      return VinsFusionFiles(rig);
    case CalibrationFormat::kBasalt:
      return BasaltFiles(rig);
    case CalibrationFormat::kOrbSlam3:
      return OrbSlam3Files(rig, camera_rate_hz);
    case CalibrationFormat::kRos:
      return RosFiles(rig);
  }
  return {};
}

void RefuseLens(const Camera& camera, const std::string& program, const std::string& known) {
  throw InputError({program + " does not know this lens model", "",
                    "the camera is " + std::string(camera.model.name()) + ", it knows " + known,
                    "calibrate with --model and one of these"});
}

void RequireImu(const RigCalibration& rig, const std::string& program) {
  if (rig.imu) return;
  throw InputError({program + " needs an IMU", "", "this result is of cameras alone",
                    "give the --out folder of calibrate camera-imu"});
}

void RequirePlainImu(const RigCalibration& rig, const std::string& program) {
  if (!rig.imu || rig.imu->model == ImuModelKind::kCalibrated) return;
  throw InputError({program + " has no place for an IMU's scale and misalignment", "",
                    "the IMU was calibrated as " + ImuModelName(rig.imu->model),
                    "calibrate with --imu-model calibrated, or correct the samples beforehand"});
}

void WarnOfWhatIsLeftOut(const RigCalibration& rig, const std::string& program,
                         bool one_time_offset, std::vector<std::string>* warnings) {
  const auto rolls = [](const auto& camera) { return camera.line_delay_s != 0.0; };
  if (std::any_of(rig.on_imu.begin(), rig.on_imu.end(), rolls)) {
    warnings->push_back(program + " has no place for a rolling shutter's line delay: left out");
  }
  if (rig.num_imus > 1) {
    warnings->push_back(program + " has one IMU: imu0 is written, the others are left out");
  }
  const auto differs = [&](const auto& camera) {
    return std::abs(camera.time_offset_s - rig.on_imu.front().time_offset_s) > 1e-9;
  };
  if (one_time_offset && std::any_of(rig.on_imu.begin(), rig.on_imu.end(), differs)) {
    warnings->push_back(program +
                        " has one time offset for all cameras: that of cam0 is written; shift the "
                        "stamps of the others by the difference");
  }
}

std::optional<std::array<double, 8>> AsPinholeRadtan(const CameraModel& model) {
  if (model.name() != "pinhole-none" && model.name() != "pinhole-radtan") return std::nullopt;
  std::array<double, 8> numbers{};
  const Eigen::VectorXd parameters = model.parameters();
  std::copy(parameters.begin(), parameters.end(), numbers.begin());
  return numbers;
}

}  // namespace calibrato
