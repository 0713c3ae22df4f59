#include "calibrato/cli/result_folder.h"

#include <filesystem>

#include "calibrato/base/input_error.h"
#include "calibrato/diagnosis/result_parameters.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

Value ReadBeside(const std::string& folder, const std::string& name) {
  const fs::path path = fs::path(folder) / name;
  if (!fs::exists(path)) {
    throw InputError({"no calibration", folder, "there is no " + name + " in it",
                      "give the --out folder of calibrate camera or calibrate camera-imu; one "
                      "without an estimate has its reasons in result.json"});
  }
  return ReadYaml(path.string());
}

}  // namespace

Value ReadResult(const std::string& folder) {
  const fs::path path = fs::path(folder) / "result.json";
  if (!fs::exists(path)) {
    throw InputError({"no result", folder, "there is no result.json in it",
                      "give the --out folder of calibrate camera or calibrate camera-imu"});
  }
  return ReadJson(path.string());
}

std::string ChainName(const std::string& calibration_kind) {
  return calibration_kind == "camera" ? "camchain.yaml" : "camchain-imucam.yaml";
}

ResultFolder ReadResultFolder(const std::string& folder) {
  ResultFolder read{folder, ReadResult(folder), {}, {}};
  const std::string kind = CalibrationKind(read.result);
  read.chain = ReadBeside(folder, ChainName(kind));
  if (kind == "camera-imu") read.imus = ReadBeside(folder, "imu.yaml");
  return read;
}

}  // namespace calibrato
