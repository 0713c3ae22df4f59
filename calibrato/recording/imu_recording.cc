#include "calibrato/recording/imu_recording.h"

#include <filesystem>
#include <optional>
#include <system_error>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/imu_list.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxImus = 100;

// Plain or packed; empty if there is neither.
std::vector<std::string> FilesOf(const std::string& folder, const std::string& name) {
  std::vector<std::string> files;
  for (const char* ending : {"", ".gz"}) {
    const fs::path path = fs::path(folder) / (name + ending);
    std::error_code error;
    if (fs::is_regular_file(path, error)) files.push_back(path.string());
  }
  return files;
}

// The one file of these that there is.
std::optional<std::string> OnlyFileOf(const std::string& folder,
                                      const std::vector<std::string>& names) {
  std::vector<std::string> files;
  for (const std::string& name : names) {
    for (std::string& file : FilesOf(folder, name)) files.push_back(std::move(file));
  }
  if (files.size() > 1) {
    throw InputError(
        {"two lists of one IMU", folder, files[0] + " and " + files[1], "remove one of them"});
  }
  if (files.empty()) return std::nullopt;
  return files.front();
}

std::optional<ImuRecording> OpenImu(const std::string& folder, int index) {
  const std::string number = std::to_string(index);
  const std::string name = "imu" + number;
  const auto both = OnlyFileOf(folder, {name + ".csv", name + "/data.csv"});
  const auto gyro = OnlyFileOf(folder, {"gyro" + number + ".csv"});
  const auto accel = OnlyFileOf(folder, {"accel" + number + ".csv"});
  if (both && (gyro || accel)) {
    throw InputError({"two lists of one IMU", folder, *both + " and " + (gyro ? *gyro : *accel),
                      "remove one of them"});
  }
  if (both) return ImuRecording{name, ReadImuList(*both)};
  if (!gyro && !accel) return std::nullopt;
  if (!gyro || !accel) {
    const std::string missing = (gyro ? "accel" : "gyro") + number + ".csv";
    throw InputError({"half an IMU", folder,
                      "there is " + (gyro ? *gyro : *accel) + ", but no " + missing,
                      "add " + missing + " or remove the other"});
  }
  return ImuRecording{name, {ReadGyroList(*gyro), ReadAccelList(*accel)}};
}

bool IsThere(const std::string& folder, int index) {
  const std::string number = std::to_string(index);
  return !FilesOf(folder, "imu" + number + ".csv").empty() ||
         !FilesOf(folder, "imu" + number + "/data.csv").empty() ||
         !FilesOf(folder, "gyro" + number + ".csv").empty();
}

}  // namespace

std::vector<ImuRecording> OpenImuRecordings(const std::string& folder) {
  std::vector<ImuRecording> imus;
  while (std::optional<ImuRecording> imu = OpenImu(folder, static_cast<int>(imus.size()))) {
    imus.push_back(*std::move(imu));
  }
  const auto count = static_cast<int>(imus.size());
  for (int i = count + 1; i < kMaxImus; ++i) {
    if (!IsThere(folder, i)) continue;
    throw InputError({"IMU missing", folder,
                      "there is imu" + std::to_string(i) + ", but no imu" + std::to_string(count),
                      "rename the IMUs so that they count from imu0"});
  }
  return imus;
}

}  // namespace calibrato
