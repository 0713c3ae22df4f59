#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <variant>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/parse.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/recording/video_writer.h"
#include "calibrato/sensors/effects.h"
#include "calibrato/simulation/outside_view.h"
#include "calibrato/simulation/rig_distribution.h"
#include "calibrato/simulation/simulated_recording.h"
#include "calibrato/simulation/simulated_run.h"

namespace calibrato {
namespace {

// Where simulated clocks begin: far from zero, as real ones are.
constexpr Time kSimulationStart = Time::FromNanoseconds(1'600'000'000'000'000'000);

struct Options {
  std::string rig;
  std::string motion;
  std::string carrier;
  std::string timing;
  std::string fidelity = "fast";
  std::string effects;
  bool scale_to_fit = false;
  bool video = false;
  std::string out;
};

// Outside view and camera's view side by side, a picture a frame.
class MotionVideo {
 public:
  explicit MotionVideo(const Rig& rig) : outside_(rig), rate_hz_(rig.camera_rate_hz) {
    std::string name = (std::filesystem::temp_directory_path() / "calibrato-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw InputError({"cannot write the video", name, "no temporary folder can be made",
                        "set TMPDIR to a folder that can be written"});
    }
    folder_ = name;
  }
  ~MotionVideo() {
    file_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  MotionVideo(const MotionVideo&) = delete;
  MotionVideo& operator=(const MotionVideo&) = delete;

  void Add(const CarrierPath& path, const SimulatedImage& image) {
    const RgbImage picture = SideBySide(outside_.Draw(path, image.t_s), image.image);
    if (!file_) file_.emplace(Name(), picture.resolution, rate_hz_);
    file_->Add(picture, image.t_s);
  }

  /// Ends the file with the motion. Returns its content.
  std::string Finish(double duration_s) {
    if (file_) file_->Finish(duration_s);
    file_.reset();
    constexpr size_t kMaxBytes = size_t{2} << 30;
    return ReadFile(Name(), kMaxBytes);
  }

 private:
  [[nodiscard]] std::string Name() const { return (folder_ / "video.avi").string(); }

  OutsideView outside_;
  double rate_hz_;
  std::filesystem::path folder_;
  std::optional<VideoWriter> file_;
};

ExitCode RunSimulate(const Options& options, const GlobalOptions& global) {
  const Fidelity fidelity = FidelityFromName(options.fidelity);
  if (options.video && fidelity != Fidelity::kRendered) {
    throw InputError({"--video shows the camera's images", "",
                      "fidelity " + FidelityName(fidelity) + " has none",
                      "add --fidelity rendered"});
  }
  if (!global.force && std::filesystem::exists(options.out)) {
    throw InputError({"there is something at --out already", options.out,
                      "a recording is not replaced unasked", "choose another name or add --force"});
  }
  OutputFolder out(options.out);
  Rig rig = ReadRig(options.rig);
  if (!options.effects.empty()) SwitchOnEffects(options.effects, &rig);
  Motion motion = ReadMotion(options.motion);
  if (!options.carrier.empty()) motion.carrier = CarrierFromName(options.carrier);
  if (!options.timing.empty()) motion.timing = TimingFromName(options.timing);
  // Of a motion that says only how to move, the board decides from where.
  if (ReadYaml(options.motion).Find("base_pose") == nullptr) {
    motion.base_pose = BasePoseBeforeBoard(rig);
  }

  auto planned = PlanMotion(motion, rig);
  if (const auto* refusal = std::get_if<Refusal>(&planned)) {
    if (!options.scale_to_fit) {
      throw InputError({"the carrier '" + CarrierName(motion.carrier) + "' can't make this motion",
                        options.motion, refusal->Describe(), refusal->remedy});
    }
    planned = PlanScaledToFit(motion, rig);
  }
  const auto& timed = std::get<TimedMotion>(planned);
  std::optional<MotionVideo> video;
  if (options.video) video.emplace(rig);
  const auto film = [&](const CarrierPath& path, const SimulatedImage& image) {
    if (video) video->Add(path, image);
  };
  const SimulatedRun run =
      SimulateRun(rig, timed, fidelity, kSimulationStart, Rng(global.seed), film);
  const size_t num_views = run.images.empty() ? run.frames.views.size() : run.images.size();
  if (num_views == 0) {
    throw InputError({"no frame shows the board", options.motion,
                      "of " + std::to_string(run.frames.num_frames) + " frames " +
                          std::to_string(run.frames.num_out_of_image) +
                          " have it outside the image, " +
                          std::to_string(run.frames.num_lost_to_blur) + " lost it to blur, " +
                          std::to_string(run.frames.num_dropped) + " were dropped",
                      "check T_w_g and T_e_c0 of the rig, or move more slowly"});
  }
  for (auto& [name, content] : SimulatedRecordingFiles(rig, timed, kSimulationStart, run)) {
    out.Add(name, content);
  }
  if (video) out.Add("video.avi", video->Finish(timed.duration_s()));
  out.Commit();
  Value summary = Value::Object();
  summary.Set("kind", "simulation")
      .Set("out", options.out)
      .Set("fidelity", FidelityName(fidelity))
      .Set("num_frames", run.frames.num_frames)
      .Set(run.images.empty() ? "num_views" : "num_images", num_views)
      .Set("num_out_of_image", run.frames.num_out_of_image)
      .Set("num_lost_to_blur", run.frames.num_lost_to_blur)
      .Set("num_dropped", run.frames.num_dropped)
      .Set("num_imu_samples", run.imu.stream.gyro.size())
      .Set("motion_s", timed.duration_s())
      .Set("scale", timed.scale)
      .Set("path_length_m", PathLength(timed.motion));
  if (run.tracking) {
    summary.Set("max_position_error_m", run.tracking->max_position_error_m)
        .Set("max_rotation_error_rad", run.tracking->max_rotation_error_rad)
        .Set("max_torque_share", run.tracking->max_torque_share);
  }
  if (global.json) {
    std::fputs(ToJson(summary).c_str(), stdout);
  } else if (!global.quiet) {
    const char* what = run.images.empty() ? "show the board" : "were rendered";
    std::printf("%zu of %d frames %s; %.2f s, path %.3f m, scale %.3f\n%s\n", num_views,
                run.frames.num_frames, what, timed.duration_s(), PathLength(timed.motion),
                timed.scale, options.out.c_str());
  }
  return kDone;
}

}  // namespace

Action SetUpSimulate(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("--rig", options->rig, "The rig and the board before it: RIG.yaml")->required();
  app.add_option("--motion", options->motion, "The motion: MOTION.yaml")->required();
  app.add_option("--carrier", options->carrier, "free or arm; else the motion's own");
  app.add_option("--timing", options->timing,
                 "quintic, or optimal (as fast as the carrier can); else the motion's own");
  app.add_option("--fidelity", options->fidelity,
                 "fast, physical (the arm's dynamics) or rendered (images too)")
      ->capture_default_str();
  app.add_option("--effects", options->effects,
                 "What real arms, cameras and IMUs do, switched on at its ordinary size: all, or "
                 "names separated by commas (docs/simulation.md)");
  app.add_flag("--scale-to-fit", options->scale_to_fit,
               "Shrink a motion that the carrier can't make, instead of refusing it");
  app.add_flag("--video", options->video,
               "Also video.avi: the arm from outside and the camera's view");
  app.add_option("--out", options->out, "Folder for the recording")->required();
  return [options, &global] { return RunSimulate(*options, global); };
}

}  // namespace calibrato
