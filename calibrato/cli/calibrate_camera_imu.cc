#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/cli/board_views.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/number_range.h"
#include "calibrato/cli/output.h"
#include "calibrato/cli/parse.h"
#include "calibrato/diagnosis/camera_imu_diagnosis.h"
#include "calibrato/diagnosis/camera_imu_document.h"
#include "calibrato/diagnosis/camera_imu_plots.h"
#include "calibrato/diagnosis/clock_steps.h"
#include "calibrato/diagnosis/stream_check.h"
#include "calibrato/diagnosis/stream_defects.h"
#include "calibrato/recording/recording.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

constexpr double kTrajectoryRateHz = 200.0;

struct Options {
  std::string recording;
  std::string target;
  std::vector<std::string> images;
  std::vector<std::string> imu_topics;
  std::optional<double> frame_rate_hz;
  std::string cameras;
  std::string camera_result;
  std::vector<std::string> imus;
  std::string imu_model;  // As the IMU's file says, if empty.
  bool estimate_noise = false;
  bool joint_intrinsics = false;
  bool line_delay = false;
  int max_iterations = 100;
  double gravity = kStandardGravity;
  RecordingWindow window;
  std::string out;
};

// Cameras with what is known of their intrinsics.
struct KnownCameras {
  std::vector<Camera> chain;
  std::vector<CameraImuCamera> cameras;  // Without views.
};

// The block of one camera's parameters in the covariance of a camera result.
Eigen::MatrixXd IntrinsicsCovariance(const Value& result, size_t camera, const CameraModel& model) {
  const Value& covariance = result.At("covariance");
  const std::vector<Value>& names = covariance.At("names").elements();
  const std::vector<Value>& rows = covariance.At("matrix").elements();
  if (rows.size() != names.size()) {
    covariance.Fail(
        "a covariance that is not square",
        std::to_string(names.size()) + " names and " + std::to_string(rows.size()) + " rows",
        "calibrate the camera again, or leave out --camera-result");
  }
  const std::string prefix = "cam" + std::to_string(camera) + ".";
  std::vector<size_t> places;
  for (const std::string& parameter : CameraModel::ParameterNames(model.name())) {
    for (size_t k = 0; k < names.size(); ++k) {
      if (names[k].AsString() == prefix + parameter) places.push_back(k);
    }
  }
  if (places.size() != static_cast<size_t>(model.num_parameters())) {
    covariance.Fail("no covariance of the parameters of " + prefix,
                    "its names and the camera's model do not go together",
                    "calibrate the camera again, or leave out --camera-result");
  }
  Eigen::MatrixXd block(model.num_parameters(), model.num_parameters());
  for (size_t i = 0; i < places.size(); ++i) {
    const std::vector<double> row = rows.at(places[i]).AsDoubles(names.size());
    for (size_t j = 0; j < places.size(); ++j) {
      block(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = row[places[j]];
    }
  }
  // Zero rows are those of parameters that were held.
  Eigen::MatrixXd whole = block;
  for (Eigen::Index k = 0; k < whole.rows(); ++k) {
    if (whole(k, k) == 0.0) whole(k, k) = 1.0;
  }
  if (!block.allFinite() || whole.llt().info() != Eigen::Success) {
    covariance.Fail("a covariance that is not positive definite", "of " + prefix,
                    "calibrate the camera again, or leave out --camera-result");
  }
  return block;
}

// Whether two chains name the same lenses with the same parameters.
bool AreTheSame(const std::vector<Camera>& one, const std::vector<Camera>& other) {
  if (one.size() != other.size()) return false;
  for (size_t n = 0; n < one.size(); ++n) {
    if (one[n].model.name() != other[n].model.name() ||
        !one[n].model.parameters().isApprox(other[n].model.parameters(), 1e-9)) {
      return false;
    }
  }
  return true;
}

KnownCameras ReadCameras(const Options& options, std::vector<std::string>* warnings) {
  if (options.cameras.empty() && options.camera_result.empty()) {
    throw InputError({"no cameras given", "", "their intrinsics must be known, at least roughly",
                      "give --cameras camchain.yaml, or --camera-result with the --out folder of "
                      "calibrate camera"});
  }
  KnownCameras known;
  if (!options.cameras.empty()) {
    known.chain = CameraChainFromValue(ReadYaml(options.cameras), warnings);
  }
  std::optional<Value> result;
  if (!options.camera_result.empty()) {
    result = ReadJson((fs::path(options.camera_result) / "result.json").string());
    if (result->At("termination").AsString() != TerminationName(Termination::kConverged)) {
      result->Fail("a camera calibration that did not converge",
                   "its parameters and their covariance say nothing",
                   "calibrate the camera again, or leave out --camera-result");
    }
    // A covariance belongs to the parameters that it was found with.
    std::vector<Camera> calibrated = CameraChainFromValue(
        ReadYaml((fs::path(options.camera_result) / "camchain.yaml").string()), warnings);
    if (!known.chain.empty() && !AreTheSame(known.chain, calibrated)) {
      warnings->push_back("--cameras and --camera-result differ: the cameras are taken from " +
                          options.camera_result);
    }
    known.chain = std::move(calibrated);
  }
  for (size_t n = 0; n < known.chain.size(); ++n) {
    CameraImuCamera camera{known.chain[n].model, {}, IntrinsicsKnowledge::kExact, {}};
    if (options.joint_intrinsics) {
      camera.intrinsics = IntrinsicsKnowledge::kUnknown;
    } else if (result) {
      camera.intrinsics = IntrinsicsKnowledge::kPrior;
      camera.intrinsics_covariance = IntrinsicsCovariance(*result, n, camera.model);
    }
    known.cameras.push_back(std::move(camera));
  }
  return known;
}

std::vector<Imu> ReadImus(const Options& options, const Recording& recording,
                          std::vector<std::string>* warnings) {
  std::vector<Imu> imus;
  for (const std::string& path : options.imus) {
    for (Imu& imu : ImusFromValue(ReadYaml(path), warnings)) imus.push_back(std::move(imu));
  }
  if (recording.imus.empty()) {
    throw InputError(
        {"no IMU in the recording", options.recording,
         "there is no imu0.csv, imu0/data.csv, gyro0.csv with accel0.csv, or topic of Imu messages",
         "put the IMU's samples there; for cameras alone: calibrato calibrate camera"});
  }
  if (imus.size() != recording.imus.size()) {
    throw InputError({"wrong number of --imu", options.recording,
                      std::to_string(imus.size()) + " given for the recording's " +
                          std::to_string(recording.imus.size()),
                      "give one a recorded IMU, in their order"});
  }
  if (!options.imu_model.empty()) {
    for (Imu& imu : imus) imu.model = ImuModelFromName(options.imu_model);
  }
  return imus;
}

CameraImuProblem MakeProblem(KnownCameras* known, const std::vector<Imu>& imus,
                             const std::vector<CheckedCamera>& cameras,
                             const std::vector<CheckedImu>& checked, const Options& options) {
  CameraImuProblem problem;
  problem.gravity = options.gravity;
  problem.estimate_line_delays = options.line_delay;
  problem.cameras = std::move(known->cameras);
  for (size_t n = 0; n < cameras.size(); ++n) problem.cameras[n].views = cameras[n].views;
  for (size_t n = 0; n < imus.size(); ++n) {
    problem.imus.push_back({Mended(checked[n].recording.stream), imus[n].noise, imus[n].model});
  }
  return problem;
}

// Kalibr's camchain-imucam.yaml: the cameras as calibrated, T_cn_cnm1 by way of the IMU.
std::string CameraChainYaml(std::vector<Camera> chain, const CameraImuState& state) {
  for (size_t n = 0; n < chain.size(); ++n) {
    chain[n].model = state.cameras[n].model;
    if (n > 0) {
      chain[n].T_cn_cnm1 = state.cameras[n].T_c_i * state.cameras[n - 1].T_c_i.Inverse();
    }
  }
  Value yaml = ToValue(chain);
  for (size_t n = 0; n < chain.size(); ++n) {
    const std::string name = "cam" + std::to_string(n);
    Value camera = yaml.At(name);
    camera.Set("T_cam_imu", ToValue(state.cameras[n].T_c_i))
        .Set("timeshift_cam_imu", state.cameras[n].time_offset_s);
    yaml.Set(name, std::move(camera));
  }
  return ToYaml(yaml);
}

std::string ImuYaml(std::vector<Imu> imus, const CameraImuCalibration& calibration) {
  const CameraImuState& state = *calibration.state;
  for (size_t n = 0; n < imus.size(); ++n) {
    imus[n].noise = NoiseAsFound(imus[n].noise, calibration.weights.imus[n]);
    imus[n].intrinsics = state.imus[n].intrinsics;
    imus[n].T_i_b = state.imus[n].T_i_imu.Inverse();
    imus[n].time_offset = Duration::FromSeconds(state.imus[n].time_offset_s);
  }
  return ToYaml(ToValue(imus));
}

// What stands at the head of a YAML that is not to be trusted, for whoever finds it without the
// result.
std::string Caution(Verdict verdict) {
  if (verdict <= Verdict::kWarn) return "";
  return "# verdict: " + std::string(VerdictName(verdict)) +
         "; not to be trusted, see result.json for why\n";
}

// T_g_i on IMU 0's clock, in the columns of truth_poses.csv.
std::string TrajectoryCsv(const CameraImuState& state) {
  std::string text = "timestamp [ns],x,y,z,qw,qx,qy,qz\n";
  const auto num_poses = static_cast<int>(std::floor(state.T_g_i.duration_s() * kTrajectoryRateHz));
  const Duration period = Duration::FromSeconds(1.0 / kTrajectoryRateHz);
  for (int k = 0; k <= num_poses; ++k) {
    const Rigid3 T_g_i = state.T_g_i.PoseAt((period * k).seconds());
    const Eigen::Quaterniond q(T_g_i.R);
    text += std::to_string((state.start + period * k).nanoseconds());
    for (const double x : {T_g_i.t.x(), T_g_i.t.y(), T_g_i.t.z(), q.w(), q.x(), q.y(), q.z()}) {
      text += "," + FormatNumber(x);
    }
    text += "\n";
  }
  return text;
}

// What lies outside of the images' window is not judged either. Clocks that do not overlap are left
// to the check of the recording.
void CutToWindow(const std::vector<CheckedCamera>& cameras, const RecordingWindow& window,
                 ImuRecording* imu) {
  if (!window.from_s && !window.to_s) return;
  std::optional<Time> begin;
  std::optional<Time> end;
  for (const CheckedCamera& camera : cameras) {
    for (const BoardView& view : camera.views) {
      if (!begin || view.stamp < *begin) begin = view.stamp;
      if (!end || *end < view.stamp) end = view.stamp;
    }
  }
  if (!begin) return;
  // Time offsets are looked for within a second.
  const Duration margin = Duration::FromSeconds(1.5);
  const auto is_outside = [&](const VectorSample& sample) {
    return sample.stamp < *begin - margin || *end + margin < sample.stamp;
  };
  ImuStream cut = imu->stream;
  std::erase_if(cut.gyro, is_outside);
  std::erase_if(cut.accel, is_outside);
  if (!cut.gyro.empty() && !cut.accel.empty()) imu->stream = std::move(cut);
}

// A corner list without an image size has that of the camera chain.
void CompleteResolutions(const KnownCameras& known, const Options& options, Recording* recording) {
  if (recording->cameras.size() != known.chain.size()) {
    throw InputError({"wrong number of cameras", options.recording,
                      "the recording has " + std::to_string(recording->cameras.size()) +
                          ", the camera chain " + std::to_string(known.chain.size()),
                      "give a chain with an entry for each recorded camera"});
  }
  for (size_t n = 0; n < known.chain.size(); ++n) {
    std::optional<Resolution>& resolution = recording->cameras[n].resolution;
    if (!resolution) resolution = known.chain[n].resolution;
  }
}

std::vector<CheckedCamera> CheckableCameras(std::vector<CameraViews> found,
                                            const KnownCameras& known) {
  std::vector<CheckedCamera> cameras;
  for (size_t n = 0; n < found.size(); ++n) {
    const std::string name = "cam" + std::to_string(n);
    const Camera& camera = known.chain[n];
    if (found[n].resolution != camera.resolution) {
      throw InputError({"another image size", name,
                        "the camera chain's is not that of the recording",
                        "give the camera chain of these images"});
    }
    cameras.push_back({name, std::move(found[n].views), camera.model});
  }
  return cameras;
}

ExitCode RunCalibrateCameraImu(const Options& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  OutputFolder out(options.out);
  std::vector<std::string> warnings;
  KnownCameras known = ReadCameras(options, &warnings);
  std::optional<Board> board;
  RecordingOptions recording_options;
  if (!options.target.empty()) {
    board = BoardFromValue(ReadYaml(options.target), &warnings);
    recording_options.board_points_g = BoardPoints(*board);
  }
  recording_options.image_globs = options.images;
  recording_options.imu_globs = options.imu_topics;
  recording_options.frame_rate_hz = options.frame_rate_hz;
  Recording recording = OpenRecording(options.recording, recording_options);
  warnings.insert(warnings.end(), recording.warnings.begin(), recording.warnings.end());
  CompleteResolutions(known, options, &recording);
  const std::vector<Imu> imus = ReadImus(options, recording, &warnings);
  PrintWarnings(warnings);

  stopwatch.Start("detection_s");
  const std::vector<CheckedCamera> cameras =
      CheckableCameras(FindBoardViews(recording, board, options.window), known);
  for (ImuRecording& imu : recording.imus) CutToWindow(cameras, options.window, &imu);
  stopwatch.Start("check_s");
  std::vector<CheckedImu> checked;
  for (size_t n = 0; n < imus.size(); ++n) checked.push_back({recording.imus[n], imus[n].noise});
  CameraImuReport report;
  report.findings = CheckStreams(cameras, checked, options.gravity);
  for (Finding& finding : CheckClocks(cameras, checked)) {
    report.findings.push_back(std::move(finding));
  }

  // A solve that can't be right is not tried: what is wrong with the recording says more.
  if (VerdictOf(report.findings) != Verdict::kFail) {
    stopwatch.Start("solve_s");
    report.problem = MakeProblem(&known, imus, cameras, checked, options);
    CameraImuOptions solver;
    solver.max_iterations = options.max_iterations;
    solver.estimate_imu_noise = options.estimate_noise;
    solver.check_knot_spacing = true;
    report.calibration = CalibrateCameraImu(report.problem, solver);
    stopwatch.Start("diagnosis_s");
    report.diagnosis = DiagnoseCameraImu(report.problem, report.calibration);
  } else {
    report.calibration.termination = Termination::kNotTried;
  }
  for (const Camera& camera : known.chain) report.resolutions.push_back(camera.resolution);

  const Value result = CameraImuResult(report);
  Value plots = Value::Object();
  plots.Set("plots", CameraImuPlots(report));
  // Those of an earlier run must not stand beside this one's result.
  for (const char* name : {"camchain-imucam.yaml", "imu.yaml", "trajectory.csv"}) out.Remove(name);
  if (report.calibration.state) {
    const CameraImuState& state = *report.calibration.state;
    const std::string caution = Caution(VerdictOf(report));
    out.Add("camchain-imucam.yaml", caution + CameraChainYaml(known.chain, state));
    out.Add("imu.yaml", caution + ImuYaml(imus, report.calibration));
    out.Add("trajectory.csv", TrajectoryCsv(state));
  }
  CommitResult("Camera-IMU calibration", result, plots, &stopwatch, &out);
  if (global.json) {
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%sreport: %s/report.html\n", CameraImuText(report).c_str(), options.out.c_str());
  }
  return VerdictOf(report) <= Verdict::kWarn ? kDone : kNotTrusted;
}

}  // namespace

Action SetUpCalibrateCameraImu(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("recording", options->recording,
                 "Folder of cameras' images or corner lists, with imu0.csv beside them; ROS 1 bag, "
                 "ROS 2 bag, MCAP file")
      ->required();
  app.add_option("--target", options->target, "The board: Kalibr's target YAML");
  app.add_option("--images", options->images,
                 "Which image topics of a bag, as a glob; once a camera");
  app.add_option("--imu-topic", options->imu_topics,
                 "Which IMU topics of a bag, as a glob; once an IMU");
  app.add_option("--frame-rate", options->frame_rate_hz, "Of videos without a list of stamps [Hz]");
  app.add_option("--cameras", options->cameras, "The cameras: Kalibr's camchain.yaml");
  app.add_option("--camera-result", options->camera_result,
                 "The --out folder of calibrate camera: its uncertainty is taken along");
  app.add_option("--imu", options->imus, "The noise of the IMU: Kalibr's imu.yaml; once an IMU")
      ->required();
  app.add_option("--imu-model", options->imu_model,
                 "calibrated, scale-misalignment or scale-misalignment-size-effect; without it, "
                 "the model that imu.yaml names, or calibrated");
  app.add_flag("--estimate-noise", options->estimate_noise,
               "Take the IMU's noise from its residuals, not from imu.yaml");
  app.add_flag("--joint-intrinsics", options->joint_intrinsics,
               "Estimate the cameras' intrinsics as well, from this recording")
      ->excludes("--camera-result");
  app.add_flag("--line-delay", options->line_delay,
               "Rolling shutters: estimate the time from one image row to the next");
  app.add_option("--max-iterations", options->max_iterations, "Of the solver")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--gravity", options->gravity, "Its size where the recording was made [m/s^2]")
      ->check(NumberBetween(1.0, 30.0))
      ->capture_default_str();
  app.add_option("--from", options->window.from_s, "Begin so late in the recording [s]");
  app.add_option("--to", options->window.to_s, "End so late in the recording [s]");
  app.add_option("--every", options->window.every, "Use one frame in so many")
      ->capture_default_str();
  app.add_option("--out", options->out, "Folder for the result")->required();
  return [options, &global] { return RunCalibrateCameraImu(*options, global); };
}

}  // namespace calibrato
