#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/calibration/planned_frame.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/number_range.h"
#include "calibrato/cli/parse.h"
#include "calibrato/guide/capture.h"
#include "calibrato/guide/frame_source.h"
#include "calibrato/guide/guide_document.h"
#include "calibrato/guide/guide_page.h"
#include "calibrato/guide/guide_session.h"
#include "calibrato/guide/imu_pipe.h"
#include "calibrato/motion/motion.h"
#include "calibrato/recording/growing_recording.h"
#include "calibrato/recording/recording.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// A page that asked so lately is still open.
constexpr std::chrono::seconds kStillOpen{4};

struct Options {
  std::string camera;
  std::string replay;
  std::string target;
  std::string cameras;
  std::string model = "pinhole-radtan";
  std::string imu;
  std::string imu_pipe;
  bool no_imu = false;
  std::vector<std::string> wanted;
  std::string policy;
  double reach_m = HandLimits().reach_m;
  double speed = 1.0;
  double max_duration_s = GuideOptions().max_duration_s;
  std::string host = "127.0.0.1";
  int port = 0;
  std::string out;
};

// What the page is told beside the session's snapshot.
class Phase {
 public:
  void Set(const std::string& phase, const std::string& words, const std::string& report) {
    const std::lock_guard lock(mutex_);
    phase_ = phase;
    words_ = words;
    report_ = report;
  }
  GuidePhase Now(double latency_ms) const {
    const std::lock_guard lock(mutex_);
    return {phase_, words_, !report_.empty(), latency_ms};
  }
  void NoteAsked() {
    const std::lock_guard lock(mutex_);
    asked_at_ = Clock::now();
  }
  std::string report() const {
    const std::lock_guard lock(mutex_);
    return report_;
  }
  bool is_watched() const {
    const std::lock_guard lock(mutex_);
    return asked_at_ && Clock::now() - *asked_at_ < kStillOpen;
  }

 private:
  mutable std::mutex mutex_;
  std::string phase_ = "capturing";
  std::string words_;
  std::string report_;
  std::optional<Clock::time_point> asked_at_;
};

void CheckOptions(const Options& options) {
  if (options.camera.empty() == options.replay.empty()) {
    throw InputError({"one source of frames is needed", "--camera or --replay",
                      options.camera.empty() ? "none is given" : "both are given",
                      "give --camera 0, or --replay with a recording"});
  }
  if (options.no_imu && !(options.imu.empty() && options.imu_pipe.empty())) {
    throw InputError({"--no-imu does not go with --imu or --imu-pipe", "", "", "leave one out"});
  }
  if (!options.cameras.empty() && options.imu.empty()) {
    throw InputError({"nothing is left to calibrate", "--cameras",
                      "the camera is known, and there is no --imu",
                      "leave out --cameras, or give --imu"});
  }
  if (!options.imu_pipe.empty() && options.camera.empty()) {
    throw InputError({"--imu-pipe does not go with --replay", "",
                      "a recording has its own IMU samples", "leave it out"});
  }
  if (!options.camera.empty() && options.imu.empty() != options.imu_pipe.empty()) {
    throw InputError({"an IMU that runs needs --imu and --imu-pipe", "", "only one is given",
                      "give its noise as imu.yaml, and the pipe that its samples come from"});
  }
}

// Runs another command of the program as if it had been typed.
ExitCode RunCommand(SetUp set_up, std::vector<std::string> words) {
  GlobalOptions quiet;
  quiet.quiet = true;
  CLI::App app;
  const Action action = set_up(app, quiet);
  std::reverse(words.begin(), words.end());  // As CLI11 takes them.
  app.parse(words);
  return action();
}

// @return the folder with the report, and how it ended.
std::pair<std::string, ExitCode> CalibrateRecording(const Options& options, bool has_imu) {
  const std::string camera_out = options.out + "/calibration-camera";
  const std::string imu_out = options.out + "/calibration";
  std::vector<std::string> words = {options.out, "--target", options.target};
  std::string chain = options.cameras;
  ExitCode code = kDone;
  if (chain.empty()) {
    std::vector<std::string> camera = words;
    camera.insert(camera.end(), {"--model", options.model, "--out", camera_out});
    code = RunCommand(SetUpCalibrateCamera, camera);
    chain = camera_out + "/camchain.yaml";
  }
  if (!has_imu || !fs::exists(chain)) return {camera_out, code};
  words.insert(words.end(), {"--cameras", chain, "--imu", options.imu, "--out", imu_out});
  if (options.cameras.empty()) words.emplace_back("--joint-intrinsics");
  return {imu_out, RunCommand(SetUpCalibrateCameraImu, words)};
}

// A policy's file of weights is for those who plan anew; what it settled on stands beside it.
Motion MotionOfPolicy(const std::string& folder, std::vector<std::string>* warnings) {
  constexpr double kShortest = 0.5;   // [s] Nobody could follow ...
  constexpr double kLongest = 120.0;  // ... or would.
  const std::string path = folder + "/motion.yaml";
  std::error_code ignored;
  if (!fs::exists(path, ignored)) {
    throw InputError({"no policy", folder, "it has no motion.yaml",
                      "give a folder policy/ as `calibrato learn` writes it"});
  }
  Motion motion = MotionFromValue(ReadYaml(path), warnings);
  for (size_t i = 0; i < motion.loops.size(); ++i) {
    const double duration_s = motion.loops[i].duration_s;
    if (duration_s >= kShortest && duration_s <= kLongest) continue;
    throw InputError({"loop " + std::to_string(i + 1) + " takes " + FormatNumber(duration_s) + " s",
                      path, "a hand follows loops of 0.5 to 120 s",
                      "change duration_s there, or leave --policy out"});
  }
  return motion;
}

ExitCode RunGuide(const Options& options, const GlobalOptions& global) {
  CheckOptions(options);
  std::vector<std::string> warnings;
  const Board board = BoardFromValue(ReadYaml(options.target), &warnings);
  GuideProblem problem;
  problem.points = PlannedView(board);
  problem.model = options.model;
  static_cast<void>(CameraModel::NumParameters(options.model));  // Refuses what is none.
  for (const std::string& word : options.wanted) SetWanted(word, &problem.wanted);
  std::optional<Motion> motion;
  if (!options.policy.empty()) motion = MotionOfPolicy(options.policy, &warnings);
  std::optional<Resolution> known_resolution;
  if (!options.cameras.empty()) {
    const std::vector<Camera> chain = CameraChainFromValue(ReadYaml(options.cameras), &warnings);
    if (chain.size() > 1) {
      throw InputError({"several cameras", options.cameras, "one camera is guided at a time",
                        "give a camera chain with its cam0 alone"});
    }
    problem.known_camera = chain.front().model;
    known_resolution = chain.front().resolution;
  }
  if (!options.imu.empty()) {
    const std::vector<Imu> imus = ImusFromValue(ReadYaml(options.imu), &warnings);
    if (imus.size() > 1) {
      throw InputError({"several IMUs", options.imu, "one IMU is guided at a time",
                        "give an imu.yaml with its imu0 alone"});
    }
    problem.imu = imus.front().noise;
  }

  std::unique_ptr<FrameSource> source;
  if (!options.replay.empty()) {
    RecordingOptions recording_options;
    recording_options.board_points_g = BoardPoints(board);
    recording_options.with_imus = !options.no_imu;
    Recording recording = OpenRecording(options.replay, recording_options);
    warnings.insert(warnings.end(), recording.warnings.begin(), recording.warnings.end());
    if (problem.imu && recording.imus.empty()) {
      throw InputError({"no IMU in the recording", options.replay, "--imu is given",
                        "leave out --imu to calibrate the camera alone"});
    }
    if (!problem.imu && !recording.imus.empty()) {
      warnings.emplace_back("the recording's IMU is left out, since --imu does not tell its noise");
      recording.imus.clear();
    }
    source = OpenReplaySource(std::move(recording), options.speed, known_resolution);
  } else {
    source = OpenCameraSource(options.camera);
  }
  PrintWarnings(warnings);
  problem.resolution = source->resolution();
  if (known_resolution && *known_resolution != problem.resolution) {
    throw InputError({"another image size", options.cameras,
                      "the camera chain's is not that of the frames",
                      "give the camera chain of this camera at this resolution"});
  }

  const bool has_imu = problem.imu.has_value();
  GuideOptions guide;
  guide.hand.reach_m = options.reach_m;
  guide.max_duration_s = options.max_duration_s;
  guide.motion = std::move(motion);
  GuideSession session(board, problem, guide);
  LatestFrame latest;
  Phase phase;
  const auto document = [&] {
    return GuideDocument(session.Snapshot(), phase.Now(latest.MedianLatencyMs()),
                         problem.resolution);
  };
  GuidePage page(options.host, options.port,
                 {[&] {
                    phase.NoteAsked();
                    return ToJsonLine(document());
                  },
                  [&] { return latest.Jpeg(); }, [&] { return phase.report(); },
                  [&] { session.End("ended on the page"); }},
                 [&](const std::string& address) {
                   std::fprintf(stderr, "open %s%s\n", address.c_str(),
                                options.host == "0.0.0.0"
                                    ? " with this machine's own address in place of 0.0.0.0"
                                    : "");
                 });
  GrowingRecording recording(options.out, problem.resolution, PointsPerTag(board));
  NoteInterruptions();
  {
    std::atomic<bool> imu_is_kept = true;
    std::unique_ptr<ImuPipe> imu;  // Last: its thread uses all the others.
    if (!options.imu_pipe.empty()) {
      imu = std::make_unique<ImuPipe>(
          options.imu_pipe,
          [&](const ImuSample& sample) {
            const bool has_gyro = session.AddGyro(sample.gyro);
            const bool has_accel = session.AddAccel(sample.accel);
            if (!has_gyro || !has_accel || !imu_is_kept) return;
            try {
              recording.AddImu(sample.gyro, sample.accel);
            } catch (const InputError& error) {
              imu_is_kept = false;
              session.End(error.what());
            }
          },
          [&] {
            session.AddWarning(
                "a line of the IMU's pipe is no sample: a stamp and six numbers are");
          });
    }
    Capture(*source, &session, &recording, &latest, [] { return InterruptRequested().load(); });
  }
  source.reset();  // Whoever wants the camera may have it.

  phase.Set("calibrating", "", "");
  ExitCode code = kNotTrusted;
  std::string folder;
  try {
    std::tie(folder, code) = CalibrateRecording(options, has_imu);
    const std::string report = folder + "/report.html";
    phase.Set("done", code == kDone ? "calibrated" : "calibrated, but not to be trusted: see why",
              fs::exists(report) ? ReadFile(report) : "");
  } catch (const InputError& error) {
    phase.Set("failed", error.what(), "");
    std::fprintf(stderr, "the recording is kept, but could not be calibrated: %s\n", error.what());
  }
  Value result = document();
  result.Set("recording", options.out).Set("calibration", folder);
  if (global.json) {
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%s after %.0f s\nrecording: %s\n", session.Snapshot().ended->c_str(),
                session.Snapshot().elapsed_s, options.out.c_str());
    if (!folder.empty()) std::printf("report: %s/report.html\n", folder.c_str());
  }
  std::fflush(stdout);
  // Whoever has the page open may read the report.
  while (phase.is_watched() && !InterruptRequested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return code;
}

}  // namespace

Action SetUpGuide(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("--camera", options->camera,
                 "A running camera: its number, its device, or the address of its stream");
  app.add_option("--replay", options->replay,
                 "A recording instead, played again: folder, bag, MCAP file or video");
  app.add_option("--target", options->target, "The board: Kalibr's target YAML")->required();
  app.add_option("--cameras", options->cameras,
                 "Kalibr's camchain.yaml, where the camera is known and --imu is given; else it is "
                 "calibrated too");
  app.add_option("--model", options->model, "Camera model, where it is not known")
      ->capture_default_str();
  app.add_option("--imu", options->imu, "Noise of the IMU: Kalibr's imu.yaml");
  app.add_option("--imu-pipe", options->imu_pipe,
                 "Where a running IMU's samples come from: a named pipe, or - for stdin; lines as "
                 "in imu0.csv, stamped by this machine's clock");
  app.add_flag("--no-imu", options->no_imu, "The camera alone");
  app.add_option("--want", options->wanted,
                 "How well to know it before it ends, as a standard deviation; any of "
                 "focal-percent=0.2 rotation-deg=0.05 translation-mm=2 time-ms=0.1");
  app.add_option("--policy", options->policy,
                 "A folder policy/ of `calibrato learn`: its motion is asked for, loop by loop, "
                 "instead of what is expected to tell most");
  app.add_option("--reach", options->reach_m, "How far the hand goes from where it begins [m]")
      ->check(NumberBetween(0.05, 2.0))
      ->capture_default_str();
  app.add_option("--speed", options->speed, "Of a replay; 0 for as fast as it can")
      ->check(NumberBetween(0.0, 0.0) | NumberBetween(0.01, 1000.0))
      ->capture_default_str();
  app.add_option("--max-duration", options->max_duration_s, "End after so long at the latest [s]")
      ->check(NumberBetween(1.0, 86400.0))
      ->capture_default_str();
  app.add_option("--host", options->host,
                 "Address of this machine to serve the page on, for a phone in the same network; "
                 "it then takes a token that is good for one browser")
      ->capture_default_str();
  app.add_option("--port", options->port, "Of the page; 0 for any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option("--out", options->out, "Folder for the recording, new or empty")->required();
  return [options, &global] { return RunGuide(*options, global); };
}

}  // namespace calibrato
