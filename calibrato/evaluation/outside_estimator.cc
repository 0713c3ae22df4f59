#include "calibrato/evaluation/outside_estimator.h"

#include <filesystem>
#include <map>

#include "calibrato/base/input_error.h"
#include "calibrato/evaluation/outside_program.h"
#include "calibrato/sensors/camera_chain.h"

namespace calibrato {
namespace {

const std::vector<std::string> kMarks = {"{bag}", "{target}", "{camchain}", "{imu}", "{out}"};

std::string Filled(std::string word, const std::map<std::string, std::string>& paths) {
  for (const auto& [mark, path] : paths) {
    const size_t at = word.find(mark);
    if (at != std::string::npos) word.replace(at, mark.size(), path);
  }
  return word;
}

void CheckMarks(const Value& word) {
  std::string rest = word.AsString();
  for (const std::string& mark : kMarks) {
    const size_t at = rest.find(mark);
    if (at != std::string::npos) rest.erase(at, mark.size());
  }
  if (rest.find_first_of("{}") != std::string::npos) {
    word.Fail("unknown mark in '" + word.AsString() + "'", "each word may hold each mark once",
              "use {bag}, {target}, {camchain}, {imu} and {out}");
  }
}

}  // namespace

OutsideEstimator OutsideEstimatorFromValue(const Value& value, std::vector<std::string>* warnings) {
  if (warnings != nullptr) {
    const std::vector<std::string> unknown = value.UnknownKeys({"name", "command", "timeout_s"});
    warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  }
  OutsideEstimator estimator;
  estimator.name = value.At("name").AsString();
  const Value& command = value.At("command");
  if (command.elements().empty()) {
    command.Fail("empty command", "it has no program",
                 "write command: [program, \"{bag}\", \"{out}\"]");
  }
  for (const Value& word : command.elements()) {
    CheckMarks(word);
    estimator.command.push_back(word.AsString());
  }
  if (const Value* timeout = value.Find("timeout_s")) estimator.timeout_s = timeout->AsPositive();
  return estimator;
}

OutsideResult RunOutsideEstimator(const OutsideEstimator& estimator, const OutsideInput& input,
                                  const std::string& folder) {
  const std::string out = folder + "/out";
  std::filesystem::create_directories(out);
  const std::map<std::string, std::string> paths = {{"{bag}", input.bag},
                                                    {"{target}", input.target},
                                                    {"{camchain}", input.camchain},
                                                    {"{imu}", input.imu},
                                                    {"{out}", out}};
  std::vector<std::string> words;
  for (const std::string& word : estimator.command) words.push_back(Filled(word, paths));
  const ProgramEnd end = RunOutsideProgram(words, folder, estimator.timeout_s);
  OutsideResult result;
  result.seconds = end.seconds;
  if (!end.is_success) {
    result.failure = end.why;
    return result;
  }
  const std::string path = out + "/camchain-imucam.yaml";
  if (!std::filesystem::exists(path)) {
    result.failure = "left no camchain-imucam.yaml";
    return result;
  }
  try {
    const Value chain = ReadYaml(path);
    const Value& camera = chain.At("cam0");
    result.T_c_i = Rigid3FromValue(camera.At("T_cam_imu"));
    if (const Value* shift = camera.Find("timeshift_cam_imu")) {
      result.time_offset_s = shift->AsDouble();
    }
  } catch (const InputError&) {
    result.failure = "left a camchain-imucam.yaml that says nothing of T_cam_imu";
  }
  return result;
}

}  // namespace calibrato
