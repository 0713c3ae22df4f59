#include "calibrato/cli/evaluate_options.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/cli/parse.h"
#include "calibrato/evaluation/recorded_trajectory.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

// The folder that holds motion.yaml: a policy's, or below that of `learn`.
fs::path PolicyFolder(const std::string& folder) {
  for (const fs::path& path : {fs::path(folder), fs::path(folder) / "policy"}) {
    if (fs::exists(path / "motion.yaml")) return path;
  }
  throw InputError({"no policy", folder, "neither motion.yaml nor policy/motion.yaml is there",
                    "give the folder that calibrato learn wrote, once it has finished"});
}

// The task that a motion was made for; none for one that serves both.
std::optional<Task> TaskIn(const Value* value) {
  const Value* task = value == nullptr || !value->IsObject() ? nullptr : value->Find("task");
  if (task == nullptr || task->AsString() == "joint") return std::nullopt;
  return TaskFromName(task->AsString());
}

// Rows that one table or another has by itself.
bool IsBuiltIn(const std::string& name) {
  static const std::set<std::string> kNames = {"random", "handcrafted", "expert",     "nominal",
                                               "robust", "oracle",      "closed loop"};
  return kNames.contains(name);
}

MotionUnderTrial ReadPolicyMotion(const std::string& words) {
  std::string name = "learned";
  std::string folder = words;
  const size_t equals = words.find('=');
  if (equals != std::string::npos && !fs::exists(words)) {
    name = words.substr(0, equals);
    folder = words.substr(equals + 1);
  }
  if (IsBuiltIn(name)) {
    throw InputError({"bad --policy '" + words + "'", "", "a row of that name is there already",
                      "give it another name"});
  }
  if (name.empty()) {
    throw InputError({"bad --policy '" + words + "'", "", "the name before = is empty",
                      "write --policy fine-tuned=DIR"});
  }
  const fs::path path = PolicyFolder(folder);
  MotionUnderTrial policy{name, ReadMotion((path / "motion.yaml").string()), {}, true};
  if (fs::exists(path / "policy.yaml")) {
    const Value header = ReadYaml((path / "policy.yaml").string());
    policy.task = TaskIn(&header);
  } else {
    policy.task = TaskIn(&std::get<Motion>(policy.way).provenance);
  }
  return policy;
}

std::string NameOf(const std::string& path) { return fs::path(path).stem().string(); }

// A file's row: only policies share a name, where they are what different training seeds gave.
std::string NewName(const std::string& path, const std::vector<MotionUnderTrial>& motions) {
  const std::string name = NameOf(path);
  const bool is_taken = std::any_of(motions.begin(), motions.end(),
                                    [&](const auto& other) { return other.policy == name; });
  if (!IsBuiltIn(name) && !is_taken) return name;
  throw InputError({"two motions named '" + name + "'", path, "a row is called after its file",
                    "give a copy of it another name"});
}

}  // namespace

void AddEvaluateOptions(CLI::App& app, EvaluateOptions* options) {
  app.add_option("--task", options->task, "intrinsic or extrinsic; else both");
  app.add_option("--policy", options->policies,
                 "Folder of a learned policy, or NAME=FOLDER (fine-tuned=out/tuned); several of "
                 "one name are training seeds of one row");
  app.add_option("--motion", options->motions, "MOTION.yaml files of others, a row each");
  app.add_option("--trajectory", options->trajectories,
                 "Recorded poses of the camera in the board's frame, TUM text format, a row each");
  app.add_option("--carrier", options->carrier, "free or arm")->capture_default_str();
  app.add_option("--fidelity", options->fidelity, "fast, physical (arm) or rendered")
      ->capture_default_str();
  CLI::Option* rigs =
      app.add_option("--rigs", options->rigs, "Distribution that rigs are drawn from")
          ->capture_default_str();
  app.add_option("--rig-file", options->rig_file, "RIG.yaml: every trial on this rig")
      ->excludes(rigs);
  CLI::Option* num_rigs =
      app.add_option("--num-rigs", options->num_rigs, "How many rigs each policy is tried on")
          ->check(CLI::Range(2, 1000000));
  app.add_flag("--quick", options->quick, "Few rigs")->excludes(num_rigs);
  app.add_option("--out", options->out, "Folder for the result")->required();
}

void AddOutsideOption(CLI::App& app, EvaluateOptions* options) {
  app.add_option("--outside", options->outside,
                 "YAML files of others' camera-IMU calibrations, run as programs (fidelity "
                 "rendered)");
}

std::vector<Task> TasksOf(const EvaluateOptions& options) {
  if (options.task.empty()) return {Task::kIntrinsic, Task::kExtrinsic};
  const Task task = TaskFromName(options.task);
  if (task != Task::kIntrinsic && task != Task::kExtrinsic) {
    throw InputError({"no table of task " + options.task, "",
                      "a motion for both is judged in each of them",
                      "use --task intrinsic or extrinsic, or leave it out"});
  }
  return {task};
}

ContestSetting SettingOf(const EvaluateOptions& options, const GlobalOptions& global, Task task,
                         const NumRigs& num_rigs) {
  ContestSetting setting;
  setting.task = task;
  setting.carrier = CarrierFromName(options.carrier);
  setting.fidelity = FidelityFromName(options.fidelity);
  if (options.rig_file.empty()) {
    setting.rigs = RigDistributionFromName(options.rigs);
  } else {
    setting.fixed_rig = ReadRig(options.rig_file);
  }
  const int usual = setting.fidelity == Fidelity::kFast ? num_rigs.fast : num_rigs.slow;
  setting.num_rigs = options.num_rigs > 0 ? options.num_rigs : usual;
  if (options.quick) setting.num_rigs = std::min(usual, num_rigs.quick);
  setting.seed = global.seed;
  return setting;
}

std::vector<MotionUnderTrial> ReadMotionsUnderTrial(const EvaluateOptions& options) {
  std::vector<MotionUnderTrial> motions;
  for (const std::string& words : options.policies) motions.push_back(ReadPolicyMotion(words));
  for (const std::string& path : options.motions) {
    motions.push_back({NewName(path, motions), ReadMotion(path), {}});
  }
  for (const std::string& path : options.trajectories) {
    motions.push_back({NewName(path, motions), ParseTumTrajectory(ReadFile(path), path), {}});
  }
  return motions;
}

}  // namespace calibrato
