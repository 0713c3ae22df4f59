#include "calibrato/evaluation/rivals.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <variant>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/progress.h"
#include "calibrato/calibration/prediction_error.h"
#include "calibrato/evaluation/filter_calibration.h"
#include "calibrato/evaluation/foreign_camera.h"
#include "calibrato/evaluation/method_row.h"
#include "calibrato/evaluation/outside_program.h"
#include "calibrato/mdp/calibration_status.h"
#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/recording/convert_recording.h"
#include "calibrato/recording/recording.h"
#include "calibrato/sensors/imu_file.h"
#include "calibrato/simulation/simulated_recording.h"
#include "calibrato/simulation/simulated_run.h"

namespace calibrato {
namespace {

constexpr double kNonsense = 0.5;  // [-] relative error
constexpr Time kStart = Time::FromNanoseconds(1'000'000'000'000);

// What an estimator makes of a trial.
struct Outcome {
  Trial trial;
  double seconds = 0.0;
};

/// All that an estimator may look at, and the truth to judge it by.
struct Case {
  const Rig* rig;
  const ExecutableMotion* motion;
  const TrialRecording* recording;
  Fidelity fidelity;
  Rng noise;
};

struct Estimator {
  std::string name;
  std::function<Outcome(const Case&)> estimate;
};

Outcome FailedOutcome(const Case& tried, const std::string& why, double seconds) {
  Outcome outcome;
  outcome.trial.failure = why;
  outcome.trial.num_frames = static_cast<int>(tried.recording->views.size());
  outcome.seconds = seconds;
  return outcome;
}

TrialRecording Thinned(TrialRecording recording, const Rig& rig, size_t most_frames) {
  const std::vector<BoardView> views =
      FramesThatCount(std::move(recording.views), rig.cameras.front().resolution, rig.board);
  recording.views.clear();
  const size_t n = std::min(most_frames, views.size());
  for (size_t k = 0; k < n; ++k) recording.views.push_back(views[k * views.size() / n]);
  return recording;
}

Outcome ByCalibrato(Task task, const Case& tried) {
  const auto start = std::chrono::steady_clock::now();
  Outcome outcome{CalibrateRecording(task, *tried.rig, *tried.recording), 0.0};
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

Outcome JudgeCamera(const Case& tried, const ForeignCamera& made) {
  if (!made.failure.empty()) return FailedOutcome(tried, made.failure, made.seconds);
  const Camera& camera = tried.rig->cameras.front();
  const Eigen::Vector4d truth = camera.model.focal_and_centre();
  const Eigen::Vector4d error = made.parameters.head<4>() - truth;
  if (!(RelativeIntrinsicError(made.parameters.head<4>(), truth) <= kNonsense) ||
      !(made.parameters.head<2>().minCoeff() > 0.0)) {
    return FailedOutcome(tried, "nonsense", made.seconds);
  }
  const CameraModel estimate("pinhole-radtan5", made.parameters);
  Outcome outcome;
  outcome.seconds = made.seconds;
  Trial& trial = outcome.trial;
  trial.num_frames = static_cast<int>(tried.recording->views.size());
  trial.relative_error = RelativeIntrinsicError(made.parameters.head<4>(), truth);
  trial.focal_error_px = error.head<2>().norm() / std::sqrt(2.0);
  trial.centre_error_px = error.tail<2>().norm() / std::sqrt(2.0);
  trial.prediction_error_px = PredictionErrorPx(estimate, camera.model, camera.resolution);
  if (made.sigmas) trial.nees = error.cwiseQuotient(*made.sigmas).squaredNorm();
  return outcome;
}

Outcome JudgeExtrinsics(const Case& tried, const Rigid3& T_c_i, std::optional<double> time_offset_s,
                        double seconds) {
  const Rig& rig = *tried.rig;
  if (!(RelativeExtrinsicError(T_c_i, rig.T_c0_i) <= kNonsense)) {
    return FailedOutcome(tried, "nonsense", seconds);
  }
  const Eigen::Matrix<double, 6, 1> error = rig.T_c0_i.DifferenceTo(T_c_i);
  const Camera& camera = rig.cameras.front();
  const double true_offset_s = rig.time_offset_i_c.seconds();
  const double line_delay_s = rig.image_disturbances.line_delay_s;
  Outcome outcome;
  outcome.seconds = seconds;
  Trial& trial = outcome.trial;
  trial.num_frames = static_cast<int>(tried.recording->views.size());
  trial.relative_error = RelativeExtrinsicError(T_c_i, rig.T_c0_i);
  trial.rotation_error_rad = error.head<3>().norm();
  trial.translation_error_m = error.tail<3>().norm();
  if (time_offset_s) trial.time_offset_error_s = std::abs(*time_offset_s - true_offset_s);
  trial.prediction_error_px = PredictionErrorPx(
      CameraCalibrationState{camera.model, T_c_i, time_offset_s.value_or(0.0), line_delay_s},
      CameraCalibrationState{camera.model, rig.T_c0_i, true_offset_s, line_delay_s},
      camera.resolution);
  return outcome;
}

Outcome ByFilter(const Case& tried) {
  const Rig& rig = *tried.rig;
  const FilterProblem problem{rig.cameras.front().model,  tried.recording->views,
                              tried.recording->imu,       rig.imu_noise,
                              rig.corner_noise.stddev_px, PriorMeanExtrinsics()};
  const auto start = std::chrono::steady_clock::now();
  const std::optional<FilterCalibration> made = CalibrateByFilter(problem);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!made) return FailedOutcome(tried, "diverged", seconds);
  // It takes the clocks for one.
  Outcome outcome = JudgeExtrinsics(tried, made->T_c_i, std::nullopt, seconds);
  if (!outcome.trial.failure.empty()) return outcome;
  const Eigen::Matrix<double, 6, 1> error = rig.T_c0_i.DifferenceTo(made->T_c_i);
  outcome.trial.nees = error.dot(made->covariance.ldlt().solve(error));
  return outcome;
}

Outcome ByOutside(const OutsideEstimator& estimator, const Case& tried) {
  if (!tried.motion->timed) {
    return FailedOutcome(tried, "recorded trajectories are not written as bags", 0.0);
  }
  const Rig& rig = *tried.rig;
  const ProgramFolder folder;
  const SimulatedRun run =
      SimulateRun(rig, *tried.motion->timed, tried.fidelity, kStart, tried.noise);
  OutputFolder recording(folder.PathOf("recording"));
  for (auto& [name, content] : SimulatedRecordingFiles(rig, *tried.motion->timed, kStart, run)) {
    recording.Add(name, content);
  }
  recording.Commit();
  const std::string bag = folder.PathOf("recording.bag");
  ConvertRecording(OpenRecording(recording.path(), {}), RecordingForm::kRosbag1, bag, false);
  WriteFileAtomically(folder.PathOf("camchain.yaml"), ToYaml(ToValue(rig.cameras)));
  WriteFileAtomically(folder.PathOf("imu.yaml"), ToYaml(ToValue(rig.imu_noise)));
  const OutsideResult made =
      RunOutsideEstimator(estimator,
                          {bag, folder.PathOf("recording/target.yaml"),
                           folder.PathOf("camchain.yaml"), folder.PathOf("imu.yaml")},
                          folder.path());
  if (!made.failure.empty()) return FailedOutcome(tried, made.failure, made.seconds);
  return JudgeExtrinsics(tried, made.T_c_i, made.time_offset_s, made.seconds);
}

bool IsInstalled(const std::string& program) {
  const ProgramFolder folder;
  constexpr double kLimit = 60.0;
  return RunOutsideProgram({program, "--help"}, folder.path(), kLimit).is_success;
}

std::vector<Estimator> EstimatorsFor(const ContestSetting& setting, const Rig& scene,
                                     const std::vector<OutsideEstimator>& outside) {
  const Task task = setting.task;
  std::vector<Estimator> estimators = {
      {"calibrato", [task](const Case& tried) { return ByCalibrato(task, tried); }}};
  if (task == Task::kIntrinsic) {
    estimators.push_back({"opencv", [](const Case& tried) {
                            return JudgeCamera(
                                tried, CalibrateByOpenCv(tried.recording->views,
                                                         tried.rig->cameras.front().resolution));
                          }});
    const auto* board = std::get_if<Checkerboard>(&scene.board);
    if (board != nullptr && IsInstalled("mrcal-calibrate-cameras")) {
      estimators.push_back({"mrcal", [board = *board](const Case& tried) {
                              return JudgeCamera(
                                  tried,
                                  CalibrateByMrcal(tried.recording->views,
                                                   tried.rig->cameras.front().resolution, board));
                            }});
    }
    return estimators;
  }
  estimators.push_back({"kalman-filter", ByFilter});
  for (const OutsideEstimator& estimator : outside) {
    if (setting.fidelity != Fidelity::kRendered) {
      throw InputError({"the estimator '" + estimator.name + "' wants images", "",
                        "fidelity " + FidelityName(setting.fidelity) + " has none",
                        "add --fidelity rendered"});
    }
    estimators.push_back(
        {estimator.name, [estimator](const Case& tried) { return ByOutside(estimator, tried); }});
  }
  return estimators;
}

// One rig and one motion, with each estimator.
std::vector<Outcome> TryAll(const ContestSetting& setting, const Rig& rig,
                            const ExecutableMotion& planned,
                            const std::vector<Estimator>& estimators, size_t most_frames,
                            const Rng& noise) {
  ExecutableMotion motion = planned;
  TrialRecording recording;
  std::string failure;
  try {
    motion = MotionOnRig(setting, planned, rig);
    recording = RecordForTrial(setting.task, rig, motion, setting.fidelity, noise);
    if (setting.task == Task::kIntrinsic) {
      recording = Thinned(std::move(recording), rig, most_frames);
    }
  } catch (const InputError& error) {
    failure = error.what();
  }
  const Case tried{&rig, &motion, &recording, setting.fidelity, noise};
  std::vector<Outcome> outcomes;
  for (const Estimator& estimator : estimators) {
    Outcome outcome =
        failure.empty() ? estimator.estimate(tried) : FailedOutcome(tried, failure, 0.0);
    outcome.trial.path_length_m = motion.path_length_m;
    outcome.trial.path_length_original_m = motion.path_length_original_m;
    outcome.trial.motion_s = motion.path.duration_s;
    outcomes.push_back(std::move(outcome));
  }
  return outcomes;
}

}  // namespace

Rivals EvaluateRivals(const ContestSetting& setting, const std::vector<MotionUnderTrial>& motions,
                      const std::vector<OutsideEstimator>& outside, size_t most_frames) {
  const std::vector<Rig> rigs = RigsUnderTrial(setting);
  const Rig scene = PlanningScene(setting);
  std::vector<Contestant> contestants = {
      RandomContestant(setting.task, setting.carrier, rigs, Rng(setting.seed)),
      FixedContestant("handcrafted", HandcraftedMotion(setting.task), setting.carrier, scene)};
  for (Contestant& brought : BroughtContestants(motions, setting.task, setting.carrier, scene)) {
    contestants.push_back(std::move(brought));
  }
  const std::vector<Estimator> estimators = EstimatorsFor(setting, scene, outside);
  const Rng rng(setting.seed);
  Progress progress("evaluating", static_cast<int64_t>(rigs.size()));
  // Of one rig: each motion with each estimator.
  const auto of_rigs = ParallelMap<std::vector<Outcome>>(rigs.size(), [&](size_t i) {
    const Rng noise = rng.Stream("evaluation noise", i);
    std::vector<Outcome> outcomes;
    for (const Contestant& contestant : contestants) {
      for (size_t m = 0; m < contestant.num_members(); ++m) {
        for (Outcome& outcome :
             TryAll(setting, rigs[i], contestant.MotionFor(m, i), estimators, most_frames, noise)) {
          outcomes.push_back(std::move(outcome));
        }
      }
    }
    progress.Advance();
    return outcomes;
  });
  Rivals rivals{setting, {}, {}};
  size_t first = 0;  // Of the contestant's outcomes: member by member, estimator by estimator.
  for (const Contestant& contestant : contestants) {
    for (size_t e = 0; e < estimators.size(); ++e) {
      RivalRow row{estimators[e].name, contestant.policy, {}};
      for (size_t m = 0; m < contestant.num_members(); ++m) {
        std::vector<Trial>& trials = row.trials.emplace_back();
        for (const std::vector<Outcome>& outcomes : of_rigs) {
          const Outcome& outcome = outcomes[first + m * estimators.size() + e];
          trials.push_back(outcome.trial);
          rivals.seconds[estimators[e].name] += outcome.seconds;
        }
      }
      rivals.rows.push_back(std::move(row));
    }
    first += contestant.num_members() * estimators.size();
  }
  return rivals;
}

Value ToValue(const std::vector<Rivals>& tasks) {
  Value rows = Value::Array();
  for (const Rivals& rivals : tasks) {
    const Rng rng = Rng(rivals.setting.seed).Stream("rivals " + TaskName(rivals.setting.task));
    for (size_t k = 0; k < rivals.rows.size(); ++k) {
      const RivalRow& made = rivals.rows[k];
      Value row = MethodRow(rivals.setting, made.policy, made.trials, rng.Stream("row", k));
      row.Set("estimator", made.estimator);
      rows.Append(std::move(row));
    }
  }
  Value value = Value::Object();
  value.Set("kind", "rivals").Set("rows", std::move(rows));
  return value;
}

std::vector<Chart> ChartsOf(const std::vector<Rivals>& tasks) {
  std::vector<Chart> charts;
  for (const Rivals& rivals : tasks) {
    Chart chart;
    chart.kind = Chart::Kind::kBoxes;
    chart.title = "Estimators and motions, " + TaskName(rivals.setting.task) + " task";
    chart.note = "Each box: one estimator on the recordings of one motion, over rigs.";
    chart.y_title = "error [%], logarithmic";
    chart.is_y_logarithmic = true;
    for (const RivalRow& row : rivals.rows) {
      ChartSeries series{row.estimator + ", " + row.policy, {}, {}, {}, {}};
      for (const double error : Existing(FiguresOf(row.trials, &Trial::relative_error))) {
        series.y.push_back(100.0 * error);
      }
      chart.series.push_back(std::move(series));
    }
    charts.push_back(std::move(chart));
  }
  return charts;
}

}  // namespace calibrato
