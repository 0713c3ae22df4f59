#include "calibrato/diagnosis/camera_imu_document.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/prediction_error.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// The parameters of one camera among the diagnosis's: three of rotation, three of translation, and
// the time offset where it was estimated.
struct CameraParameters {
  const ParameterVerdict* rotation = nullptr;
  const ParameterVerdict* translation = nullptr;
  const ParameterVerdict* time_offset = nullptr;  // Null where it was held.
};

CameraParameters ParametersOf(const CameraImuReport& report, size_t camera) {
  const size_t size = report.problem.estimate_time_offsets ? 7 : 6;
  const ParameterVerdict* first = &report.diagnosis.parameters[camera * size];
  return {first, first + 3, size == 7 ? first + 6 : nullptr};
}

Value Sigmas(const ParameterVerdict* three) {
  Value value = Value::Array();
  for (int k = 0; k < 3; ++k) value.Append(three[k].sigma);
  return value;
}

Value Verdicts(const ParameterVerdict* three) {
  Value value = Value::Array();
  for (int k = 0; k < 3; ++k) value.Append(VerdictName(three[k].verdict));
  return value;
}

// Stamps as in the recording, to find them there; times as on the page.
void SetLeftOut(const std::string& what, const std::vector<LeftOut>& left_out, Value* value) {
  Value stamps = Value::Array();
  Value times = Value::Array();
  for (const LeftOut& one : left_out) {
    stamps.Append(one.stamp.nanoseconds());
    times.Append(std::round(1e6 * one.time_s) / 1e6);
  }
  value->Set(what + "_stamps_ns", std::move(stamps)).Set(what + "_times_s", std::move(times));
}

// Null without a covariance.
Value ExpectedPredictionError(const CameraImuReport& report, size_t n) {
  const CameraImuCalibration& calibration = report.calibration;
  if (calibration.information.covariance.size() == 0 || n >= report.resolutions.size()) return {};
  const CameraImuLayout layout(report.problem, calibration.state->T_g_i.order());
  return report.diagnosis.sigma_scale() *
         ExpectedPredictionErrorPx(calibration.state->cameras[n], report.resolutions[n],
                                   layout.cameras[n], calibration.information.covariance);
}

Value CameraValue(const CameraImuReport& report, size_t n) {
  const CameraCalibrationState& camera = report.calibration.state->cameras[n];
  const CameraParameters parameters = ParametersOf(report, n);
  const CornerResiduals& residuals = report.diagnosis.residuals->cameras[n];
  Value verdicts = Value::Object();
  verdicts.Set("rotation", Verdicts(parameters.rotation))
      .Set("translation", Verdicts(parameters.translation));
  Value value = Value::Object();
  value.Set("T_cam_imu", ToValue(camera.T_c_i))
      .Set("time_offset_s", camera.time_offset_s)
      .Set("rotation_sigma_rad", Sigmas(parameters.rotation))
      .Set("translation_sigma_m", Sigmas(parameters.translation));
  if (parameters.time_offset != nullptr) {
    value.Set("time_offset_sigma_s", parameters.time_offset->sigma);
    verdicts.Set("time_offset", VerdictName(parameters.time_offset->verdict));
  }
  value.Set("verdicts", std::move(verdicts));
  if (report.problem.estimate_line_delays) {
    const CameraImuLayout layout(report.problem, report.calibration.state->T_g_i.order());
    const auto column = static_cast<size_t>(layout.cameras[n].line_delay);
    value.Set("line_delay_s", camera.line_delay_s)
        .Set("line_delay_sigma_s",
             report.diagnosis.sigma_scale() * SigmasOf(report.calibration.information)[column]);
  }
  if (report.diagnosis.split) {
    const CameraImuSplit::Camera& split = report.diagnosis.split->cameras[n];
    Value halves = Value::Object();
    halves.Set("difference_rad_m_s", Value::Numbers(split.difference))
        .Set("sigma_rad_m_s", Value::Numbers(split.sigma))
        .Set("probability", split.significance.probability);
    value.Set("split", std::move(halves));
  }
  Value rejected = Value::Array();
  for (const std::string& name : residuals.rejected_views) rejected.Append(name);
  value.Set("reprojection_rms_px", residuals.rms_px)
      .Set("num_views", residuals.num_views)
      .Set("num_corners", residuals.num_corners)
      .Set("num_outliers", residuals.num_outliers)
      .Set("rejected_views", std::move(rejected));
  SetLeftOut("rejected_view", residuals.rejected, &value);
  value.Set("prediction_error_px", ExpectedPredictionError(report, n));
  return value;
}

Value SensorValue(const SensorResiduals& residuals) {
  Value value = Value::Object();
  value.Set("rms", residuals.rms)
      .Set("normalised", residuals.normalised)
      .Set("num_samples", residuals.num_samples)
      .Set("num_outliers", static_cast<int64_t>(residuals.outliers.size()));
  SetLeftOut("outlier", residuals.outliers, &value);
  return value;
}

Value NoiseValue(const ImuNoise& noise) {
  Value value = Value::Object();
  value.Set("gyro_noise_density", noise.gyro_noise_density)
      .Set("accel_noise_density", noise.accel_noise_density);
  return value;
}

// The biases' covariances are the last, six an IMU.
void SetBiasSigmas(const CameraImuDiagnosis& diagnosis, size_t imu, size_t num_imus, Value* value) {
  const Eigen::MatrixXd& covariance = diagnosis.covariance.matrix;
  if (covariance.size() == 0) return;
  const Eigen::VectorXd sigmas = diagnosis.sigma_scale() * covariance.diagonal().cwiseSqrt();
  const auto first = sigmas.size() - static_cast<Eigen::Index>(6 * (num_imus - imu));
  value->Set("gyro_bias_sigma", Value::Numbers(Eigen::Vector3d(sigmas.segment<3>(first))))
      .Set("accel_bias_sigma", Value::Numbers(Eigen::Vector3d(sigmas.segment<3>(first + 3))));
}

Value ImuValue(const CameraImuReport& report, size_t n) {
  const ImuCalibrationState& imu = report.calibration.state->imus[n];
  const ImuBias bias = MeanBias(imu);
  const ImuNoise found =
      NoiseAsFound(report.problem.imus[n].noise, report.calibration.weights.imus[n]);
  Value value = Value::Object();
  value.Set("model", ImuModelName(report.problem.imus[n].model))
      .Set("gyro_bias", Value::Numbers(bias.gyro))
      .Set("accel_bias", Value::Numbers(bias.accel));
  SetBiasSigmas(report.diagnosis, n, report.problem.imus.size(), &value);
  value.Set("gyro", SensorValue(report.diagnosis.residuals->gyros[n]))
      .Set("accel", SensorValue(report.diagnosis.residuals->accels[n]))
      .Set("noise", NoiseValue(found))
      .Set("stated_noise", NoiseValue(report.problem.imus[n].noise))
      .Set("T_i_imu", ToValue(imu.T_i_imu))
      .Set("time_offset_s", imu.time_offset_s);
  SetImuIntrinsics(imu.intrinsics, report.problem.imus[n].model, &value);
  return value;
}

Value ScatterValue(const std::optional<CameraImuScatter>& scatter) {
  if (!scatter) return {};
  Value value = Value::Object();
  value.Set("num_parts", scatter->num_parts)
      .Set("ratio", scatter->ratio)
      .Set("probability", scatter->probability)
      .Set("sigma_scale", scatter->sigma_scale());
  return value;
}

Value ImuModelsValue(const std::optional<ImuModelComparison>& models) {
  if (!models) return {};
  Value change = Value::Array();
  for (const auto& of_camera : models->change) change.Append(Value::Numbers(of_camera));
  const std::string simple(ImuModelName(ImuModelKind::kCalibrated));
  const std::string richer(ImuModelName(ImuModelKind::kScaleMisalignment));
  Value value = Value::Object();
  value.Set("simple", simple)
      .Set("richer", richer)
      .Set("used", models->is_simple_used ? simple : richer)
      .Set("squared_residuals_fall", models->significance.statistic)
      .Set("degrees", models->significance.degrees)
      .Set("probability", models->significance.probability)
      .Set("qaic_change", models->qaic_change())
      .Set("change_rad_m", std::move(change));
  return value;
}

Value CovarianceValue(const NamedCovariance& covariance, double sigma_scale) {
  if (covariance.matrix.size() == 0) return {};
  Value names = Value::Array();
  for (const std::string& name : covariance.names) names.Append(name);
  Value matrix = Value::Array();
  for (Eigen::Index row = 0; row < covariance.matrix.rows(); ++row) {
    matrix.Append(
        Value::Numbers(Eigen::VectorXd(sigma_scale * sigma_scale * covariance.matrix.row(row))));
  }
  Value value = Value::Object();
  value.Set("names", std::move(names)).Set("matrix", std::move(matrix));
  return value;
}

Value InformationValue(const CameraImuInformation& information) {
  if (information.covariance.size() == 0) return {};
  Value value = Value::Object();
  value.Set("a_optimality", information.extrinsics.a_optimality)
      .Set("d_optimality", information.extrinsics.d_optimality)
      .Set("e_optimality", information.extrinsics.e_optimality)
      .Set("eigenvalues", Value::Numbers(information.extrinsics.eigenvalues))
      .Set("a_optimality_conditional", information.a_optimality_conditional);
  return value;
}

Value ResidualsValue(const CameraImuReport& report) {
  const CameraImuResidualSummary& residuals = *report.diagnosis.residuals;
  Value value = Value::Object();
  value.Set("reprojection_rms_px", report.calibration.reprojection_rms_px)
      .Set("reprojection_rms_all_px", report.calibration.reprojection_rms_all_px)
      .Set("corner_noise_px", report.calibration.weights.corner_noise_px)
      .Set("reprojection_normalised", residuals.cameras.front().normalised)
      .Set("gyro_rms_rad_s", residuals.gyros.front().rms)
      .Set("gyro_normalised", residuals.gyros.front().normalised)
      .Set("accel_rms_m_s2", residuals.accels.front().rms)
      .Set("accel_normalised", residuals.accels.front().normalised);
  return value;
}

// "52.0123 +- 0.1034 mm  pass", "52 mm, not observable".
std::string WithSigma(double value, const ParameterVerdict* parameter, double one_unit,
                      const char* unit) {
  if (parameter == nullptr) return Format("%.4f %s, held", value / one_unit, unit);
  if (std::isnan(parameter->sigma)) {
    return Format("%.4f %s, not observable", value / one_unit, unit);
  }
  return Format("%.4f +- %.4f %s  %s", value / one_unit, parameter->sigma / one_unit, unit,
                std::string(VerdictName(parameter->verdict)).c_str());
}

std::string EstimateText(const CameraImuReport& report) {
  constexpr const char* kAxes = "xyz";
  std::string text;
  const CameraImuState& state = *report.calibration.state;
  for (size_t n = 0; n < state.cameras.size(); ++n) {
    const CameraCalibrationState& camera = state.cameras[n];
    const CameraParameters parameters = ParametersOf(report, n);
    const CornerResiduals& residuals = report.diagnosis.residuals->cameras[n];
    text += Format("cam%zu  T_cam_imu from %d views, %d corners, rms %.3f px\n", n,
                   residuals.num_views, residuals.num_corners, residuals.rms_px);
    const Eigen::Vector3d turn = LogSo3(camera.T_c_i.R);
    for (int k = 0; k < 3; ++k) {
      text += Format("  rotation %c     %s\n", kAxes[k],
                     WithSigma(turn(k), parameters.rotation + k, kDegree, "degrees").c_str());
    }
    for (int k = 0; k < 3; ++k) {
      text += Format("  translation %c  %s\n", kAxes[k],
                     WithSigma(camera.T_c_i.t(k), parameters.translation + k, 1e-3, "mm").c_str());
    }
    if (report.problem.estimate_line_delays) {
      text += Format("  line delay     %.4f us\n", 1e6 * camera.line_delay_s);
    }
    text += Format("  time offset    %s\n",
                   WithSigma(camera.time_offset_s, parameters.time_offset, 1e-3, "ms").c_str());
  }
  for (size_t n = 0; n < state.imus.size(); ++n) {
    const ImuBias bias = MeanBias(state.imus[n]);
    text += Format(
        "imu%zu  gyro bias %.5f %.5f %.5f rad/s, accel bias %.4f %.4f %.4f m/s^2\n"
        "      residuals over stated noise: gyro %.2f, accel %.2f\n",
        n, bias.gyro.x(), bias.gyro.y(), bias.gyro.z(), bias.accel.x(), bias.accel.y(),
        bias.accel.z(), report.diagnosis.residuals->gyros[n].normalised,
        report.diagnosis.residuals->accels[n].normalised);
  }
  text += Format("gravity in the board's frame %.4f %.4f %.4f m/s^2\n", state.gravity_g.x(),
                 state.gravity_g.y(), state.gravity_g.z());
  return text;
}

}  // namespace

std::vector<Finding> FindingsOf(const CameraImuReport& report) {
  std::vector<Finding> all = report.diagnosis.findings;
  all.insert(all.end(), report.findings.begin(), report.findings.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return all;
}

Verdict VerdictOf(const CameraImuReport& report) { return VerdictOf(FindingsOf(report)); }

Value CameraImuResult(const CameraImuReport& report) {
  const CameraImuCalibration& calibration = report.calibration;
  Value result = Value::Object();
  result.Set("kind", "camera-imu")
      .Set("termination", TerminationName(calibration.termination))
      .Set("verdict", VerdictName(VerdictOf(report)))
      .Set("findings", ToValue(FindingsOf(report)));
  if (!calibration.state) return result;
  Value cameras = Value::Array();
  for (size_t n = 0; n < report.problem.cameras.size(); ++n) {
    cameras.Append(CameraValue(report, n));
  }
  Value imus = Value::Array();
  for (size_t n = 0; n < report.problem.imus.size(); ++n) imus.Append(ImuValue(report, n));
  result.Set("cameras", std::move(cameras))
      .Set("imus", std::move(imus))
      .Set("gravity_g", Value::Numbers(calibration.state->gravity_g))
      .Set("knot_spacing_s", calibration.knot_spacing_s)
      .Set("change_with_finer_knots", calibration.change_with_finer_knots
                                          ? Value(*calibration.change_with_finer_knots)
                                          : Value())
      .Set("num_iterations", calibration.num_iterations)
      .Set("scatter", ScatterValue(report.diagnosis.scatter))
      .Set("imu_models", ImuModelsValue(report.diagnosis.imu_models))
      .Set("covariance",
           CovarianceValue(report.diagnosis.covariance, report.diagnosis.sigma_scale()))
      .Set("information", InformationValue(calibration.information))
      .Set("residuals", ResidualsValue(report));
  return result;
}

std::string CameraImuText(const CameraImuReport& report) {
  std::string text =
      "camera-imu  " + std::string(TerminationName(report.calibration.termination)) + "\n";
  if (report.calibration.state) text += EstimateText(report);
  text += "verdict: " + std::string(VerdictName(VerdictOf(report))) + "\n";
  for (const Finding& finding : FindingsOf(report)) {
    text += "  - " + finding.what;
    if (!finding.remedy.empty()) text += "; " + finding.remedy;
    text += "\n";
  }
  return text;
}

}  // namespace calibrato
