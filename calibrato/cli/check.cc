#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/cli/board_views.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/number_range.h"
#include "calibrato/cli/output.h"
#include "calibrato/cli/parse.h"
#include "calibrato/diagnosis/check_document.h"
#include "calibrato/diagnosis/recording_check.h"
#include "calibrato/recording/recording.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

// Images of each camera whose sharpness and light are looked at.
constexpr size_t kImagesToLookAt = 120;
// Of the IMU, before the first and after the last image [s].
constexpr double kMargin = 1.5;

struct Options {
  std::string recording;
  std::string target;
  std::string cameras;
  std::vector<std::string> imus;
  RecordingOptions recording_options;
  std::string resolution;
  double gravity = kStandardGravity;
  RecordingWindow window;
  std::string out;
};

// The recording; without cameras where it has none and none were asked for.
Recording OpenForCheck(const Options& options, RecordingOptions recording_options,
                       std::vector<Finding>* findings) {
  recording_options.cameras_may_be_missing = options.cameras.empty() && options.target.empty();
  Recording recording = OpenRecording(options.recording, recording_options);
  if (recording.cameras.empty()) {
    findings->push_back(
        {Severity::kInfo, "the IMU alone is checked, since there are no cameras", ""});
  }
  return recording;
}

std::vector<Imu> ReadImus(const Options& options, const Recording& recording,
                          std::vector<std::string>* warnings) {
  std::vector<Imu> imus;
  for (const std::string& path : options.imus) {
    for (Imu& imu : ImusFromValue(ReadYaml(path), warnings)) imus.push_back(std::move(imu));
  }
  if (!imus.empty() && imus.size() != recording.imus.size()) {
    throw InputError({"wrong number of --imu", options.recording,
                      std::to_string(imus.size()) + " given for the recording's " +
                          std::to_string(recording.imus.size()),
                      "give one a recorded IMU, in their order, or none"});
  }
  return imus;
}

std::vector<Camera> ReadCameras(const Options& options, const Recording& recording,
                                std::vector<std::string>* warnings) {
  if (options.cameras.empty()) return {};
  std::vector<Camera> chain = CameraChainFromValue(ReadYaml(options.cameras), warnings);
  if (chain.size() != recording.cameras.size()) {
    throw InputError({"wrong number of cameras", options.recording,
                      "the recording has " + std::to_string(recording.cameras.size()) +
                          ", the camera chain " + std::to_string(chain.size()),
                      "give a chain of the recording's cameras, in their order, or none"});
  }
  return chain;
}

// In the order in which they were recorded.
std::vector<Time> StampsOf(const CameraRecording& camera) {
  std::vector<Time> stamps;
  if (const auto* views = std::get_if<std::vector<BoardView>>(&camera.data)) {
    for (const BoardView& view : *views) stamps.push_back(view.stamp);
  } else {
    const auto& images = std::get<CameraImages>(camera.data);
    if (!images.stamps_as_recorded.empty()) return images.stamps_as_recorded;
    for (const RecordedImage& image : images.list) stamps.push_back(image.stamp);
  }
  return stamps;
}

// A stretch of time, from the first image (else the first sample) of the recording on.
struct Window {
  Time zero;
  double from_s;
  double to_s;
  bool Has(Time stamp, double margin_s) const {
    const double t = (stamp - zero).seconds();
    return t >= from_s - margin_s && t <= to_s + margin_s;
  }
};

std::optional<Window> WindowOf(const Recording& recording, const RecordingWindow& window) {
  if (!window.from_s && !window.to_s) return std::nullopt;
  std::optional<Time> zero;
  const auto note = [&](Time stamp) { zero = zero ? std::min(*zero, stamp) : stamp; };
  for (const CameraRecording& camera : recording.cameras) {
    for (const Time stamp : StampsOf(camera)) note(stamp);
  }
  if (!zero) {
    for (const ImuRecording& imu : recording.imus) {
      for (const VectorSample& sample : imu.stream.gyro) note(sample.stamp);
    }
  }
  constexpr double kAlways = 1e9;
  return Window{zero.value_or(Time()), window.from_s.value_or(-kAlways),
                window.to_s.value_or(kAlways)};
}

// Sharpness and light of some images, evenly chosen.
std::vector<ImageQuality> LookAtImages(const CameraImages& images,
                                       const std::optional<Board>& board,
                                       const CameraToCheck& camera) {
  const std::set<Time> kept(camera.stamps.begin(), camera.stamps.end());
  std::vector<size_t> inside;
  for (size_t k = 0; k < images.list.size(); ++k) {
    if (kept.contains(images.list[k].stamp)) inside.push_back(k);
  }
  const size_t count = std::min(inside.size(), kImagesToLookAt);
  return ParallelMap<ImageQuality>(count, [&](size_t i) {
    const size_t k = inside[i * inside.size() / count];
    const GreyImage image = GreyOf(images.reader->Read(k));
    ImageQuality quality{images.list[k].stamp, BrightnessOf(image), std::nullopt};
    for (const BoardView& view : camera.views) {
      if (board && view.name == images.list[k].name) {
        quality.board = SharpnessOf(image, view, *board);
      }
    }
    return quality;
  });
}

CameraToCheck LookAtCamera(const Recording& recording, size_t n, const std::optional<Board>& board,
                           const std::vector<Camera>& chain, const Options& options,
                           const std::optional<Window>& window) {
  CameraRecording of_camera = recording.cameras[n];
  if (!of_camera.resolution && !chain.empty()) of_camera.resolution = chain[n].resolution;
  CameraToCheck camera;
  camera.name = "cam" + std::to_string(n);  // As the calibration calls it; of_camera's is a topic.
  camera.has_images = std::holds_alternative<CameraImages>(of_camera.data);
  camera.resolution = of_camera.resolution;
  if (!chain.empty()) camera.model = chain[n].model;
  for (const Time stamp : StampsOf(of_camera)) {
    if (!window || window->Has(stamp, 0.0)) camera.stamps.push_back(stamp);
  }
  // What keeps the board from being found, or an image from being read, is what is looked for here.
  try {
    if (!camera.has_images || board) {
      RecordingWindow of_one = options.window;
      if (window && !camera.stamps.empty()) {
        // Counted from this camera's own first image.
        const std::vector<Time> stamps = StampsOf(of_camera);
        const double ahead_s =
            (*std::min_element(stamps.begin(), stamps.end()) - window->zero).seconds();
        if (of_one.from_s) *of_one.from_s -= ahead_s;
        if (of_one.to_s) *of_one.to_s -= ahead_s;
      }
      const Recording alone{recording.path, {of_camera}, {}, {}};
      CameraViews found = std::move(FindBoardViews(alone, board, of_one).front());
      camera.was_searched = true;
      camera.views = std::move(found.views);
      camera.resolution = found.resolution;
      camera.rejected = found.rejected;
      const std::set<std::string> without(found.images_without_board.begin(),
                                          found.images_without_board.end());
      if (camera.has_images) {
        for (const RecordedImage& image : std::get<CameraImages>(of_camera.data).list) {
          if (without.contains(image.name)) camera.stamps_without_board.push_back(image.stamp);
        }
      }
    }
    if (camera.has_images) {
      const auto& images = std::get<CameraImages>(of_camera.data);
      camera.images = LookAtImages(images, board, camera);
      if (!camera.resolution && !images.list.empty()) {
        camera.resolution = GreyOf(images.reader->Read(0)).resolution;
      }
    }
    if (!chain.empty() && camera.resolution && camera.resolution != chain[n].resolution) {
      camera.model.reset();
      throw InputError({"another image size", "", "the camera chain's is not that of the recording",
                        "give the camera chain of these images"});
    }
  } catch (const InputError& error) {
    camera.search_findings.push_back({Severity::kFail, camera.name + ": " + error.what(), ""});
  }
  return camera;
}

ExitCode RunCheck(const Options& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  std::optional<OutputFolder> out;
  if (!options.out.empty()) out.emplace(options.out);
  std::vector<std::string> warnings;
  std::optional<Board> board;
  if (!options.target.empty()) board = BoardFromValue(ReadYaml(options.target), &warnings);
  stopwatch.Start("reading_s");
  RecordingOptions recording_options = options.recording_options;
  if (board) recording_options.board_points_g = BoardPoints(*board);
  if (!options.resolution.empty()) {
    recording_options.resolution = ParseResolution(options.resolution);
  }
  std::vector<Finding> findings;
  const Recording recording = OpenForCheck(options, recording_options, &findings);
  warnings.insert(warnings.end(), recording.warnings.begin(), recording.warnings.end());
  const std::vector<Camera> chain = ReadCameras(options, recording, &warnings);
  const std::vector<Imu> imus = ReadImus(options, recording, &warnings);
  PrintWarnings(warnings);
  for (const std::string& warning : recording.warnings) {
    findings.push_back({Severity::kWarn, warning, ""});
  }

  stopwatch.Start("detection_s");
  const std::optional<Window> window = WindowOf(recording, options.window);
  RecordingToCheck to_check;
  to_check.gravity = options.gravity;
  for (size_t n = 0; n < recording.cameras.size(); ++n) {
    to_check.cameras.push_back(LookAtCamera(recording, n, board, chain, options, window));
  }
  for (size_t n = 0; n < recording.imus.size(); ++n) {
    CheckedImu imu{recording.imus[n], std::nullopt};
    if (!imus.empty()) imu.noise = imus[n].noise;
    if (window) {
      const auto is_outside = [&](const VectorSample& sample) {
        return !window->Has(sample.stamp, kMargin);
      };
      std::erase_if(imu.recording.stream.gyro, is_outside);
      std::erase_if(imu.recording.stream.accel, is_outside);
    }
    to_check.imus.push_back(std::move(imu));
  }
  stopwatch.Start("check_s");
  RecordingCheck check = CheckRecording(to_check);
  check.findings.insert(check.findings.end(), findings.begin(), findings.end());
  std::stable_sort(check.findings.begin(), check.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });

  const Value result = CheckResult(to_check, check);
  if (out) {
    Value plots = Value::Object();
    plots.Set("plots", CheckPlots(to_check, check));
    CommitResult("Check of a recording", result, plots, &stopwatch, &*out);
  }
  if (global.json) {
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::fputs(CheckText(to_check, check).c_str(), stdout);
    if (out) std::printf("report: %s/report.html\n", options.out.c_str());
  }
  return VerdictOf(check.findings) <= Verdict::kWarn ? kDone : kNotTrusted;
}

}  // namespace

Action SetUpCheck(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("recording", options->recording,
                 "Folder, ROS 1 bag, ROS 2 bag, MCAP file or video, of cameras, IMUs or both")
      ->required();
  app.add_option("--target", options->target,
                 "The board: Kalibr's target YAML; without it, images are not searched");
  app.add_option("--cameras", options->cameras,
                 "The cameras, if their intrinsics are known: Kalibr's camchain.yaml");
  app.add_option("--imu", options->imus,
                 "The noise of the IMU: Kalibr's imu.yaml; once an IMU. With it, the sigmas of the "
                 "extrinsics are expected");
  app.add_option("--images", options->recording_options.image_globs,
                 "Which photos or image topics, as a glob; once a camera");
  app.add_option("--imu-topic", options->recording_options.imu_globs,
                 "Which IMU topics of a bag, as a glob; once an IMU");
  app.add_option("--frame-rate", options->recording_options.frame_rate_hz,
                 "Of a video without a list of stamps [Hz]");
  app.add_option("--resolution", options->resolution,
                 "Image size of corner lists, WIDTHxHEIGHT, if no file tells it");
  app.add_option("--gravity", options->gravity, "Its size where the recording was made [m/s^2]")
      ->check(NumberBetween(1.0, 30.0))
      ->capture_default_str();
  app.add_option("--from", options->window.from_s, "Begin so late in the recording [s]");
  app.add_option("--to", options->window.to_s, "End so late in the recording [s]");
  app.add_option("--every", options->window.every, "Search one image in so many for the board")
      ->capture_default_str();
  app.add_option("--out", options->out, "Folder for the result; without it, it is only printed");
  return [options, &global] { return RunCheck(*options, global); };
}

}  // namespace calibrato
