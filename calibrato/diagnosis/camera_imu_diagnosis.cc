#include "calibrato/diagnosis/camera_imu_diagnosis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/diagnosis/board_scale_check.h"
#include "calibrato/diagnosis/turning_advice.h"

namespace calibrato {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// The three kinds of numbers in a result, and when they are too uncertain.
struct Kind {
  const char* what;
  const char* preposition;
  const char* unit;
  double one_unit;      // In SI.
  double inconclusive;  // Sigma above it [SI].
  double warn;
};
constexpr Kind kRotation = {"rotation", " about ",     "degrees",
                            kDegree,    1.0 * kDegree, 0.2 * kDegree};
constexpr Kind kTranslation = {"translation", " along ", "mm", 1e-3, 0.020, 0.005};
constexpr Kind kTimeOffset = {"time offset", "", "ms", 1e-3, 0.005, 0.0005};

constexpr double kTooLargeResiduals = 3.0;  // Over the stated noise [-].
constexpr double kNoisyResiduals = 1.5;
constexpr double kDisagreement = 3.0;  // Of halves, in sigmas.
constexpr double kLargeChange = 0.5;   // With finer knots, in sigmas.
constexpr double kManyOutside = 0.05;  // Of all measurements; a few always are.
constexpr int kNumKnowledge = 16;
constexpr int kNumParts = 4;  // Whose scatter is looked at.
constexpr size_t kNamesToList = 3;

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

Verdict VerdictOfSigma(const Kind& kind, double sigma) {
  if (!(sigma <= kind.inconclusive)) return Verdict::kInconclusive;
  return sigma > kind.warn ? Verdict::kWarn : Verdict::kPass;
}

std::string Name(const char* sensor, size_t n) { return sensor + std::to_string(n); }

// How fast the rig turned about each axis of the camera, root mean square [rad/s].
Eigen::Vector3d TurningOf(const CameraImuProblem& problem, const CameraImuState& state,
                          size_t camera) {
  Eigen::Vector3d squared = Eigen::Vector3d::Zero();
  const std::vector<VectorSample>& gyro = problem.imus.front().stream.gyro;
  for (const VectorSample& sample : gyro) {
    const double t = TimeOfSample(state, 0, sample.stamp);
    const Eigen::Vector3d rate = sample.value - state.BiasAt(0, t).gyro;
    squared += (state.cameras[camera].T_c_i.R * rate).cwiseAbs2();
  }
  return (squared / std::max<size_t>(1, gyro.size())).cwiseSqrt();
}

std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (size_t k = 0; k < std::min(names.size(), kNamesToList); ++k) {
    text += (k == 0 ? "" : ", ") + names[k];
  }
  return names.size() > kNamesToList ? text + ", .." : text;
}

// "5.015, 10.000, .. s after the beginning"
std::string ListedTimes(const std::vector<LeftOut>& left_out) {
  std::vector<std::string> times;
  for (const LeftOut& one : left_out) times.push_back(Format("%.3f", one.time_s));
  return Listed(times) + " s after the beginning";
}

// "x (38 mm), y (44 mm)"; a sigma that does not exist is left out.
std::string AxesWithSigmas(const Kind& kind, const std::vector<int>& axes,
                           const ParameterVerdict* three) {
  std::string text;
  for (const int axis : axes) {
    const double sigma = three[axis].sigma / kind.one_unit;
    text += (text.empty() ? "" : ", ") + std::string(kAxes[size_t(axis)]);
    if (std::isfinite(sigma)) text += Format(" (%.2g %s)", sigma, kind.unit);
  }
  return text;
}

// Findings on a vector's three components, those that are alike in one.
void AddFindings(const std::string& camera, const Kind& kind, const ParameterVerdict* three,
                 const Eigen::Vector3d& turning, std::vector<Finding>* findings) {
  std::vector<int> unobservable;
  std::vector<int> undetermined;
  std::vector<int> uncertain;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isnan(three[axis].sigma)) {
      unobservable.push_back(axis);
    } else if (three[axis].verdict == Verdict::kInconclusive) {
      undetermined.push_back(axis);
    } else if (three[axis].verdict == Verdict::kWarn) {
      uncertain.push_back(axis);
    }
  }
  const auto add = [&](Severity severity, const std::vector<int>& axes, const std::string& is) {
    if (axes.empty()) return;
    const int worst = *std::max_element(
        axes.begin(), axes.end(), [&](int a, int b) { return three[a].sigma < three[b].sigma; });
    findings->push_back(
        {severity,
         camera + ": the " + kind.what + kind.preposition + AxesWithSigmas(kind, axes, three) + is,
         AdviceOnTurning(worst, turning)});
  };
  add(Severity::kInconclusive, unobservable, " is not observable in this motion");
  add(Severity::kInconclusive, undetermined, " is not determined (one sigma)");
  add(Severity::kWarn, uncertain, " is not known well (one sigma)");
}

void AddTimeOffsetFinding(const std::string& camera, const ParameterVerdict& parameter,
                          std::vector<Finding>* findings) {
  if (parameter.verdict == Verdict::kPass) return;
  const bool is_known = parameter.verdict == Verdict::kWarn;
  const std::string size =
      std::isnan(parameter.sigma)
          ? " is not observable in this motion"
          : Format(" is %s: one sigma is %.2g ms", is_known ? "not known well" : "not determined",
                   1e3 * parameter.sigma);
  findings->push_back({is_known ? Severity::kWarn : Severity::kInconclusive,
                       camera + ": the time offset" + size,
                       "turn the rig to and fro faster, about any axis"});
}

void JudgeCamera(const CameraImuProblem& problem, const CameraImuState& state,
                 const CameraImuLayout& layout, const std::vector<double>& sigmas, size_t n,
                 CameraImuDiagnosis* diagnosis) {
  const Eigen::Vector3d turning = TurningOf(problem, state, n);
  const CameraImuLayout::Camera& columns = layout.cameras[n];
  const auto parameter = [&](const Kind& kind, int column) {
    const auto k = static_cast<size_t>(column);
    return ParameterVerdict{layout.names[k], sigmas[k], VerdictOfSigma(kind, sigmas[k])};
  };
  std::vector<ParameterVerdict> parameters;
  for (int k = 0; k < 3; ++k) parameters.push_back(parameter(kRotation, columns.pose + k));
  for (int k = 3; k < 6; ++k) parameters.push_back(parameter(kTranslation, columns.pose + k));
  AddFindings(Name("cam", n), kRotation, &parameters[0], turning, &diagnosis->findings);
  AddFindings(Name("cam", n), kTranslation, &parameters[3], turning, &diagnosis->findings);
  if (columns.time_offset >= 0) {
    parameters.push_back(parameter(kTimeOffset, columns.time_offset));
    AddTimeOffsetFinding(Name("cam", n), parameters.back(), &diagnosis->findings);
  }
  diagnosis->parameters.insert(diagnosis->parameters.end(), parameters.begin(), parameters.end());
}

// Halves that disagree: a warning for each parameter that does, a finding for each camera.
void JudgeSplit(CameraImuDiagnosis* diagnosis) {
  if (!diagnosis->split) return;
  size_t k = 0;
  for (size_t n = 0; n < diagnosis->split->cameras.size(); ++n) {
    const CameraImuSplit::Camera& camera = diagnosis->split->cameras[n];
    std::string differences;
    for (Eigen::Index i = 0; i < camera.difference.size(); ++i) {
      if (camera.sigma(i) == 0.0) continue;
      ParameterVerdict& parameter = diagnosis->parameters[k++];
      const double difference = std::abs(camera.difference(i));
      if (!(difference > kDisagreement * camera.sigma(i))) continue;
      const Kind& kind = i < 3 ? kRotation : i < 6 ? kTranslation : kTimeOffset;
      parameter.verdict = std::max(parameter.verdict, Verdict::kWarn);
      differences += (differences.empty() ? "" : ", ") +
                     Format("%s by %.2g %s (%.1f sigmas)", parameter.name.c_str(),
                            difference / kind.one_unit, kind.unit, difference / camera.sigma(i));
    }
    if (differences.empty()) continue;
    diagnosis->findings.push_back(
        {Severity::kWarn, "the two halves of the recording disagree: " + differences,
         "look for what changed (a camera that is loose on the rig, a board that moved) or for "
         "what all sigmas rest on (the cameras' intrinsics, the noise densities)"});
  }
}

void JudgeSamples(const std::string& imu, const std::string& sensor,
                  const SensorResiduals& residuals, std::vector<Finding>* findings) {
  if (!(residuals.normalised <= kTooLargeResiduals)) {
    findings->push_back({Severity::kFail,
                         Format("%s: the %s does not fit: its residuals are %.1f times the noise "
                                "that is stated for it",
                                imu.c_str(), sensor.c_str(), residuals.normalised),
                         "check the noise densities, units and stamps; if the sensor is of a "
                         "cheap kind, try --imu-model scale-misalignment"});
  } else if (residuals.normalised > kNoisyResiduals || residuals.normalised < 1 / kNoisyResiduals) {
    findings->push_back(
        {Severity::kInfo,
         Format("%s: the %s's residuals are %.2f times the noise that is stated for it, and all "
                "sigmas rest on that",
                imu.c_str(), sensor.c_str(), residuals.normalised),
         "give --estimate-noise, or the noise densities that the IMU has when it moves"});
  }
  if (!residuals.outliers.empty()) {
    findings->push_back(
        {Severity::kInfo,
         Format("%s: %zu of %d samples of the %s do not fit and were left out, ", imu.c_str(),
                residuals.outliers.size(), residuals.num_samples, sensor.c_str()) +
             ListedTimes(residuals.outliers),
         ""});
  }
}

void JudgeCorners(const std::string& camera, const CornerResiduals& residuals,
                  std::vector<Finding>* findings) {
  if (!residuals.rejected_views.empty()) {
    findings->push_back({Severity::kInfo,
                         camera +
                             Format(": %zu of %d images do not fit and were left out: ",
                                    residuals.rejected_views.size(), residuals.num_views) +
                             Listed(residuals.rejected_views) + ", " +
                             ListedTimes(residuals.rejected),
                         "wrong stamps look like that, and boards that were found wrongly"});
  }
  if (residuals.num_outliers > 0) {
    findings->push_back(
        {Severity::kInfo,
         camera + Format(": %d corners do not fit and were left out, of %d", residuals.num_outliers,
                         residuals.num_outliers + residuals.num_corners),
         ""});
  }
}

// Noise that was estimated, beside what is stated.
void AddNoiseFinding(const std::string& imu, const std::string& sensor, double found, double stated,
                     std::vector<Finding>* findings) {
  const double ratio = found / stated;
  if (std::abs(ratio - 1.0) < 1e-6) return;
  findings->push_back({Severity::kInfo,
                       Format("%s: the noise density of the %s is estimated at %.3g, which is %.2f "
                              "times what is stated",
                              imu.c_str(), sensor.c_str(), found, ratio),
                       ""});
}

void AddNoiseFindings(const CameraImuProblem& problem, const CameraImuWeights& weights,
                      std::vector<Finding>* findings) {
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    const ImuNoise& stated = problem.imus[n].noise;
    const ImuNoise found = NoiseAsFound(stated, weights.imus[n]);
    AddNoiseFinding(Name("imu", n), "gyroscope", found.gyro_noise_density,
                    stated.gyro_noise_density, findings);
    AddNoiseFinding(Name("imu", n), "accelerometer", found.accel_noise_density,
                    stated.accel_noise_density, findings);
  }
}

void JudgeResiduals(const CameraImuResidualSummary& residuals, std::vector<Finding>* findings) {
  for (size_t n = 0; n < residuals.cameras.size(); ++n) {
    JudgeCorners(Name("cam", n), residuals.cameras[n], findings);
  }
  for (size_t n = 0; n < residuals.gyros.size(); ++n) {
    JudgeSamples(Name("imu", n), "gyroscope", residuals.gyros[n], findings);
    JudgeSamples(Name("imu", n), "accelerometer", residuals.accels[n], findings);
  }
}

void AddScatterFinding(const CameraImuScatter& scatter, std::vector<Finding>* findings) {
  if (scatter.sigma_scale() == 1.0) return;
  findings->push_back(
      {Severity::kInfo,
       Format("%d parts of the recording, each calibrated alone, lie %.1f times as far apart as "
              "independent errors would put them; all sigmas were multiplied by that",
              scatter.num_parts, scatter.sigma_scale()),
       "look for errors that last: cameras' intrinsics of another day, a board that is bent or "
       "moved, a camera that is loose, a vibrating or cheap IMU"});
}

// Where the IMUs are not as their model has them, and the result depends on it.
void JudgeImuModel(const ImuModelComparison& models, CameraImuDiagnosis* diagnosis) {
  if (!models.is_simple_used || !models.significance.is_significant()) return;
  const size_t num_parameters = diagnosis->parameters.size() / models.change.size();
  std::string changes;
  for (size_t n = 0; n < models.change.size(); ++n) {
    for (size_t k = 0; k < 6; ++k) {
      ParameterVerdict& parameter = diagnosis->parameters[n * num_parameters + k];
      const double change = models.change[n](static_cast<Eigen::Index>(k));
      if (!(std::abs(change) > kDisagreement * parameter.sigma)) continue;
      parameter.verdict = std::max(parameter.verdict, Verdict::kWarn);
      const Kind& kind = k < 3 ? kRotation : kTranslation;
      changes += (changes.empty() ? "" : ", ") +
                 Format("%s by %.2g %s", parameter.name.c_str(), change / kind.one_unit, kind.unit);
    }
  }
  if (changes.empty()) return;
  diagnosis->findings.push_back(
      {Severity::kWarn,
       Format("the IMU has scale errors or misaligned axes (squared residuals would fall by %.0f, "
              "where %.0f is chance), which moves the result: ",
              models.significance.statistic, models.significance.degrees) +
           changes,
       "give --imu-model scale-misalignment"});
}

Finding NoStartFinding(const CameraImuNoStart& none) {
  using Reason = CameraImuNoStart::Reason;
  const std::string camera = Name("cam", none.sensor);
  const std::string imu = Name("imu", none.sensor);
  switch (none.reason) {
    case Reason::kNoBoardPoses:
      return {Severity::kFail,
              "there is nothing to start from: hardly an image of " + camera +
                  " tells where the board is",
              "check the camera's intrinsics and the board's target file"};
    case Reason::kViewsFarApart:
      return {Severity::kFail,
              Format("there is nothing to start from: hardly two images of %s that show the board "
                     "are less than %.1f s apart",
                     camera.c_str(), kLongestViewInterval),
              "record 10 images a second or more, with the board in view; leave out --every"};
    case Reason::kNoSharedTime:
      return {Severity::kFail,
              "there is nothing to start from: " + camera +
                  " and imu0 recorded at different times, as their clocks have it",
              "record both at the same time, and give both stamps of one clock"};
    case Reason::kNoTurning:
      return {Severity::kFail,
              "there is nothing to start from: " + camera + " or imu0 never turned",
              "turn the rig about all axes, with the board in view"};
    case Reason::kOtherImu:
      return {Severity::kFail,
              "there is nothing to start from: " + imu + " and imu0 did not turn at the same times",
              "check that both are on one rigid body, and that their stamps are of one clock"};
  }
  return {};
}

double NumMeasurements(const CameraImuProblem& problem) {
  size_t number = 0;
  for (const CameraImuCamera& camera : problem.cameras) number += camera.views.size();
  for (const CameraImuImu& imu : problem.imus) {
    number += imu.stream.gyro.size() + imu.stream.accel.size();
  }
  return static_cast<double>(number);
}

}  // namespace

CameraImuDiagnosis DiagnoseCameraImu(const CameraImuProblem& problem,
                                     const CameraImuCalibration& calibration) {
  CameraImuDiagnosis diagnosis;
  if (!calibration.state) {
    if (calibration.no_start) diagnosis.findings = {NoStartFinding(*calibration.no_start)};
    return diagnosis;
  }
  const CameraImuState& state = *calibration.state;
  // Where the data leave something undetermined, the parameters' findings say what.
  if (calibration.termination != Termination::kConverged &&
      calibration.termination != Termination::kRankDeficient) {
    diagnosis.findings.push_back(
        {Severity::kFail,
         "the solve did not converge: " + std::string(TerminationName(calibration.termination)),
         std::string(calibration.termination == Termination::kIterationLimit
                         ? "give --max-iterations more, or look"
                         : "look") +
             " at what the check of the recording found"});
  }
  const CameraImuLayout layout(problem, state.T_g_i.order());
  if (calibration.termination == Termination::kConverged) {
    diagnosis.scatter = ScatterOfParts(problem, calibration, kNumParts);
    if (diagnosis.scatter) AddScatterFinding(*diagnosis.scatter, &diagnosis.findings);
  }
  std::vector<double> sigmas = SigmasOf(calibration.information);
  for (double& sigma : sigmas) sigma *= diagnosis.sigma_scale();
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    JudgeCamera(problem, state, layout, sigmas, n, &diagnosis);
  }
  if (calibration.termination == Termination::kRankDeficient &&
      VerdictOf(diagnosis.findings) < Verdict::kInconclusive) {
    diagnosis.findings.push_back(
        {Severity::kInconclusive,
         "the recording does not determine all that was to be estimated beside the cameras' poses",
         "estimate less, or turn the rig about all axes and shake it along all of them"});
  }
  if (calibration.termination == Termination::kConverged) {
    diagnosis.split = CheckSplit(problem, calibration, diagnosis.sigma_scale());
    JudgeSplit(&diagnosis);
    diagnosis.imu_models = CompareImuModels(problem, calibration, diagnosis.sigma_scale());
  }
  std::optional<BoardScaleCheck> board;
  if (!problem.estimate_board_scale) board = CheckBoardScale(problem, calibration);
  if (board) {
    diagnosis.findings.push_back(BoardScaleFinding(*board));
  } else if (diagnosis.imu_models) {
    // A board of another size looks like scale errors of the IMU.
    JudgeImuModel(*diagnosis.imu_models, &diagnosis);
  }
  diagnosis.covariance = CovarianceWithBiases(problem, calibration);
  diagnosis.residuals = SummariseResiduals(problem, calibration);
  JudgeResiduals(*diagnosis.residuals, &diagnosis.findings);
  AddNoiseFindings(problem, calibration.weights, &diagnosis.findings);
  if (calibration.change_with_finer_knots > kLargeChange * diagnosis.sigma_scale()) {
    diagnosis.findings.push_back(
        {Severity::kInfo,
         Format(
             "the motion is hardly followed by a trajectory with knots every %.3g ms: with knots "
             "twice as dense the result moves by %.1f sigmas",
             1e3 * calibration.knot_spacing_s,
             *calibration.change_with_finer_knots / diagnosis.sigma_scale()),
         "move less abruptly: knocks and vibration are faster than the IMU's samples can show"});
  }
  if (calibration.num_outside > kManyOutside * NumMeasurements(problem)) {
    diagnosis.findings.push_back(
        {Severity::kInfo,
         Format("%d images and samples lie before or after the time that camera and IMU share, and "
                "play no part",
                calibration.num_outside),
         ""});
  }
  diagnosis.knowledge =
      KnowledgeOverTime(problem, calibration, kNumKnowledge, diagnosis.sigma_scale());

  if (VerdictOf(diagnosis.findings) == Verdict::kFail) {
    for (ParameterVerdict& parameter : diagnosis.parameters) parameter.verdict = Verdict::kFail;
  }
  std::stable_sort(diagnosis.findings.begin(), diagnosis.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return diagnosis;
}

}  // namespace calibrato
