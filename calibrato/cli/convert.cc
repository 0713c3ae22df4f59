#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/parse.h"
#include "calibrato/recording/convert_recording.h"
#include "calibrato/recording/recording.h"

namespace calibrato {
namespace {

struct Options {
  std::string recording;
  std::string form;
  RecordingOptions recording_options;
  std::string out;
};

ExitCode RunConvert(const Options& options, const GlobalOptions& global) {
  const RecordingForm form = RecordingFormFromName(options.form);
  const Recording recording = OpenRecording(options.recording, options.recording_options);
  PrintWarnings(recording.warnings);
  const ConversionResult result = ConvertRecording(recording, form, options.out, global.force);
  Value summary = Value::Object();
  summary.Set("kind", "conversion")
      .Set("out", options.out)
      .Set("to", options.form)
      .Set("num_cameras", recording.cameras.size())
      .Set("num_imus", recording.imus.size())
      .Set("num_images", result.num_images)
      .Set("num_imu_samples", result.num_imu_samples);
  if (global.json) {
    std::fputs(ToJson(summary).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%lld images of %zu cameras, %lld samples of %zu IMUs\n%s\n",
                static_cast<long long>(result.num_images), recording.cameras.size(),
                static_cast<long long>(result.num_imu_samples), recording.imus.size(),
                options.out.c_str());
  }
  return kDone;
}

}  // namespace

Action SetUpConvert(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("recording", options->recording,
                 "Folder, ROS 1 bag, ROS 2 bag, MCAP file or video")
      ->required();
  app.add_option("--to", options->form, "folder, rosbag1 or mcap")->required();
  app.add_option("--images", options->recording_options.image_globs,
                 "Which photos or image topics, as a glob; once a camera");
  app.add_option("--imu-topic", options->recording_options.imu_globs,
                 "Which IMU topics of a bag, as a glob; once an IMU");
  app.add_option("--frame-rate", options->recording_options.frame_rate_hz,
                 "Of a video without a list of stamps [Hz]");
  app.add_option("--out", options->out, "The new folder or file")->required();
  return [options, &global] { return RunConvert(*options, global); };
}

}  // namespace calibrato
