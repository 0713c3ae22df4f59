#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/calibration/imu_noise.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/parse.h"
#include "calibrato/diagnosis/noise_document.h"
#include "calibrato/recording/recording.h"
#include "calibrato/report/report.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string recording;
  RecordingOptions recording_options;
  std::string out;
};

// The page beside the YAML: imu.html beside imu.yaml.
std::string PagePath(const std::string& yaml) {
  return fs::path(yaml).replace_extension(".html").string();
}

std::string ImuYaml(const std::vector<NamedNoise>& imus) {
  const auto topic = [](const std::string& name) {
    return name.starts_with('/') ? name : "/" + name;
  };
  if (imus.size() == 1) {
    return ToYaml(ToValue(imus.front().estimate.noise(), topic(imus.front().name)));
  }
  std::vector<Imu> entries;
  for (const NamedNoise& imu : imus) {
    entries.emplace_back();
    entries.back().noise = imu.estimate.noise();
    entries.back().rostopic = topic(imu.name);
  }
  return ToYaml(ToValue(entries));
}

ExitCode RunNoise(const Options& options, const GlobalOptions& global) {
  if (PagePath(options.out) == options.out) {
    throw InputError({"bad --out", options.out, "that is the name of the page beside it",
                      "give a file that ends in .yaml"});
  }
  const fs::path folder = fs::path(options.out).parent_path();
  if (!folder.empty() && !fs::is_directory(folder)) {
    throw InputError({"no such folder", folder.string(), "--out is to be written there",
                      "make it, or check the spelling of the path"});
  }
  RecordingOptions imus_alone = options.recording_options;
  imus_alone.with_cameras = false;
  const Recording recording = OpenRecording(options.recording, imus_alone);
  PrintWarnings(recording.warnings);
  if (recording.imus.empty()) {
    throw InputError({"no IMU in the recording", options.recording,
                      "there is no imu0.csv, imu0/data.csv, gyro0.csv with accel0.csv, or topic of "
                      "Imu messages",
                      "give a log of the IMU lying still"});
  }
  std::vector<NamedNoise> imus;
  for (const ImuRecording& imu : recording.imus) {
    imus.push_back({imu.name, EstimateImuNoise(imu.name, imu.stream)});
    PrintWarnings(imus.back().estimate.warnings);
  }
  const Value result = NoiseResult(imus);
  const std::string page = ReportHtml("Noise of an IMU", {result});
  WriteFileAtomically(PagePath(options.out), page);
  WriteFileAtomically(options.out, ImuYaml(imus));
  if (global.json) {
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%s%s\nreport: %s\n", NoiseText(imus).c_str(), options.out.c_str(),
                PagePath(options.out).c_str());
  }
  return kDone;
}

}  // namespace

Action SetUpNoise(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("recording", options->recording,
                 "A log of the IMU lying still, three hours or more: folder, ROS 1 bag, ROS 2 bag, "
                 "MCAP file")
      ->required();
  app.add_option("--imu-topic", options->recording_options.imu_globs,
                 "Which IMU topics of a bag, as a glob; once an IMU");
  app.add_option("--out", options->out,
                 "Kalibr's imu.yaml; the Allan deviation is drawn on a page beside it, imu.html")
      ->required();
  return [options, &global] { return RunNoise(*options, global); };
}

}  // namespace calibrato
