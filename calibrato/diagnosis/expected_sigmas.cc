#include "calibrato/diagnosis/expected_sigmas.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/camera_imu_start.h"
#include "calibrato/calibration/knot_spacing.h"
#include "calibrato/diagnosis/camera_imu_parts.h"
#include "calibrato/diagnosis/turning_advice.h"

namespace calibrato {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kOfFocalLength = 0.01;
constexpr double kMostRecording = 60.0;  // That is asked for [s].
constexpr double kStep = 5.0;            // In which it is asked for [s].

// A kind of parameter: how it is called, and when it is known well.
struct Kind {
  const char* part;  // Of its name, between "cam0." and "_x".
  const char* what;
  const char* unit;
  double one_unit;  // [SI]
  double enough;
  double inconclusive;
};
constexpr Kind kRotation = {"rot", "rotation", "degrees", kDegree, 0.2 * kDegree, 1.0 * kDegree};
constexpr Kind kTranslation = {"pos", "translation", "mm", 1e-3, 0.005, 0.020};
constexpr Kind kTimeOffset = {"time_offset", "time offset", "ms", 1e-3, 0.0005, 0.005};
constexpr Kind kIntrinsics = {"", "focal length or principal point", "px", 1.0, 0.0, 0.0};

// "cam0" of "cam0.rot_x". Names of cameras may have points of their own.
std::string CameraOf(const std::string& name) { return name.substr(0, name.rfind('.')); }

const Kind& KindOf(const std::string& name) {
  for (const Kind* kind : {&kRotation, &kTranslation, &kTimeOffset}) {
    if (name.substr(name.rfind('.') + 1).starts_with(kind->part)) return *kind;
  }
  return kIntrinsics;
}

// How much longer a recording must be for its sigma to fall to what is enough; in whole steps.
double MoreSeconds(double sigma, double enough, double duration_s) {
  const double ratio = sigma / enough;
  return kStep * std::ceil(duration_s * (ratio * ratio - 1.0) / kStep);
}

// How fast the rig turned about each axis of the camera, root mean square [rad/s].
Eigen::Vector3d TurningOf(const std::vector<VectorSample>& gyro, const Eigen::Vector3d& bias,
                          const Eigen::Matrix3d& R_c_i) {
  Eigen::Vector3d squared = Eigen::Vector3d::Zero();
  for (const VectorSample& sample : gyro) squared += (R_c_i * (sample.value - bias)).cwiseAbs2();
  return (squared / static_cast<double>(std::max<size_t>(1, gyro.size()))).cwiseSqrt();
}

std::string AdviceFor(const Kind& kind, int axis, double sigma, double duration_s,
                      const Eigen::Vector3d& turning) {
  const std::string motion = &kind == &kTimeOffset
                                 ? "turn the rig to and fro faster, about any axis"
                                 : AdviceOnTurning(axis, turning);
  const double more_s = MoreSeconds(sigma, kind.enough, duration_s);
  if (!(more_s <= kMostRecording)) return motion;
  if (&kind == &kTimeOffset) return Format("record %.0f s more, and turn faster", more_s);
  return Format("record %.0f s more, rotate about %s", more_s,
                AxisToTurnAbout(axis, turning).c_str());
}

}  // namespace

std::vector<ExpectedSigma> ExpectedIntrinsics(const std::string& name, const CameraProblem& problem,
                                              const CameraCalibration& calibration) {
  std::vector<ExpectedSigma> expected;
  const std::vector<std::string> names = CameraModel::ParameterNames(problem.model);
  const int first = CameraModel::FocalIndex(problem.model);
  const bool is_known = calibration.model && calibration.covariance.size() != 0;
  double duration_s = 0.0;
  if (!problem.views.empty()) {
    duration_s = (problem.views.back().stamp - problem.views.front().stamp).seconds();
  }
  for (size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    ExpectedSigma parameter{name + "." + names[i], kNan, kNan, Verdict::kPass, ""};
    if (is_known) parameter.sigma = std::sqrt(calibration.covariance(k, k));
    if (k >= first && k < first + 4) {
      if (is_known) {
        const Eigen::Index focal = first + (k - first) % 2;
        parameter.enough = kOfFocalLength * calibration.model->parameters()(focal);
      }
      if (!(parameter.sigma <= parameter.enough)) {
        parameter.verdict = Verdict::kInconclusive;
        const double more_s =
            duration_s > 0.0 ? MoreSeconds(parameter.sigma, parameter.enough, duration_s) : kNan;
        parameter.advice = "tilt the board by 30 degrees and more to all sides, and bring it near";
        if (more_s <= kMostRecording) {
          parameter.advice = Format("record %.0f s more, ", more_s) + parameter.advice;
        }
      }
    }
    expected.push_back(std::move(parameter));
  }
  return expected;
}

std::vector<ExpectedSigma> ExpectedExtrinsics(const CameraImuProblem& problem) {
  CameraImuProblem started = problem;
  const ImuStream& stream = problem.imus.front().stream;
  const auto found = FindCameraImuStart(problem, {}, KnotSpacingFor(stream));
  const auto* start = std::get_if<CameraImuStart>(&found);
  if (start == nullptr) return {};
  started.corner_noise_px = problem.corner_noise_px.value_or(start->corner_noise_px);
  for (size_t n = 0; n < started.cameras.size(); ++n) {
    std::vector<BoardView> fitting;
    for (size_t v = 0; v < started.cameras[n].views.size(); ++v) {
      if (!start->suspects.views[n][v]) fitting.push_back(started.cameras[n].views[v]);
    }
    started.cameras[n].views = std::move(fitting);
  }
  const CameraImuInformation information = InformationAt(started, start->state);
  const std::vector<double> sigmas = SigmasOf(information);
  const CameraImuLayout layout(started, start->state.T_g_i.order());
  const double duration_s = start->state.T_g_i.duration_s();

  std::vector<ExpectedSigma> expected;
  for (size_t n = 0; n < layout.cameras.size(); ++n) {
    const Eigen::Vector3d turning = TurningOf(stream.gyro, start->state.imus[0].biases[0].gyro,
                                              start->state.cameras[n].T_c_i.R);
    const auto add = [&](const Kind& kind, int column, int axis) {
      const double sigma = sigmas[static_cast<size_t>(column)];
      ExpectedSigma parameter{information.names[static_cast<size_t>(column)], sigma, kind.enough,
                              Verdict::kPass, ""};
      if (!(sigma <= kind.enough)) {
        parameter.verdict = sigma <= kind.inconclusive ? Verdict::kWarn : Verdict::kInconclusive;
        parameter.advice = AdviceFor(kind, axis, sigma, duration_s, turning);
      }
      expected.push_back(std::move(parameter));
    };
    for (int axis = 0; axis < 3; ++axis) add(kRotation, layout.cameras[n].pose + axis, axis);
    for (int axis = 0; axis < 3; ++axis) add(kTranslation, layout.cameras[n].pose + 3 + axis, axis);
    if (layout.cameras[n].time_offset >= 0) add(kTimeOffset, layout.cameras[n].time_offset, 0);
  }
  return expected;
}

std::string SigmaText(const ExpectedSigma& parameter) {
  if (std::isnan(parameter.sigma)) return "none";
  const Kind& kind = KindOf(parameter.name);
  // Shapes and distortion have no unit.
  if (&kind == &kIntrinsics && std::isnan(parameter.enough)) return Format("%.2g", parameter.sigma);
  return Format("%.2g %s", parameter.sigma / kind.one_unit, kind.unit);
}

std::vector<Finding> FindingsOnExpectedSigmas(const std::vector<ExpectedSigma>& expected) {
  std::vector<Finding> findings;
  for (size_t first = 0; first < expected.size();) {
    const Kind& kind = KindOf(expected[first].name);
    const std::string camera = CameraOf(expected[first].name);
    const auto is_alike = [&](const ExpectedSigma& other) {
      return &KindOf(other.name) == &kind && CameraOf(other.name) == camera;
    };
    const ExpectedSigma* worst = nullptr;
    std::string names;
    size_t end = first;
    for (; end < expected.size() && is_alike(expected[end]); ++end) {
      const ExpectedSigma& parameter = expected[end];
      if (parameter.verdict == Verdict::kPass) continue;
      names += (names.empty() ? "" : ", ") + parameter.name;
      names += std::isnan(parameter.sigma) ? " (does not show)" : " (" + SigmaText(parameter) + ")";
      const auto size = [](const ExpectedSigma& p) {
        return std::isnan(p.sigma) ? std::numeric_limits<double>::infinity() : p.sigma;
      };
      if (worst == nullptr || size(parameter) > size(*worst)) worst = &parameter;
    }
    if (worst != nullptr) {
      const bool is_open = worst->verdict == Verdict::kInconclusive;
      findings.push_back({is_open ? Severity::kInconclusive : Severity::kWarn,
                          camera + ": this recording " +
                              (is_open ? "would not determine the " : "would not tell well the ") +
                              kind.what + ": expected sigma of " + names,
                          worst->advice});
    }
    first = std::max(first + 1, end);
  }
  return findings;
}

}  // namespace calibrato
