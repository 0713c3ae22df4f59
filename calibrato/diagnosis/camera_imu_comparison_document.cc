#include "calibrato/diagnosis/camera_imu_comparison_document.h"

#include <algorithm>
#include <cmath>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/prediction_error.h"
#include "calibrato/diagnosis/finding.h"
#include "calibrato/sensors/camera_chain.h"

namespace calibrato {
namespace {

CameraCalibrationState StateOf(const Camera& camera, const Value& in_result) {
  const Value* line_delay = in_result.Find("line_delay_s");
  return {camera.model, Rigid3FromValue(in_result.At("T_cam_imu")),
          in_result.At("time_offset_s").AsDouble(),
          line_delay == nullptr ? 0.0 : line_delay->AsDouble()};
}

// Where the parameters of one camera stand in its part of the summed covariance; held ones count as
// exact.
struct CameraPart {
  CameraImuLayout::Camera columns;
  Eigen::MatrixXd covariance;
};

CameraPart PartOfCamera(const ResultParameters& first, const ResultParameters& second,
                        const std::string& name) {
  CameraPart part;
  std::vector<std::string> groups;
  int size = 0;
  const auto add = [&](const std::string& what) {
    const ParameterGroup* a = first.Find(name + what);
    const ParameterGroup* b = second.Find(name + what);
    if (a == nullptr || b == nullptr || a->names != b->names) return -1;
    groups.push_back(a->name);
    size += static_cast<int>(a->size());
    return size - static_cast<int>(a->size());
  };
  part.columns.pose = add(" pose");
  part.columns.time_offset = add(" time offset");
  part.columns.line_delay = add(" line delay");
  part.columns.parameters = add(" lens");
  part.covariance = first.CovarianceOf(groups) + second.CovarianceOf(groups);
  return part;
}

std::string Chance(const Significance& significance) {
  if (!significance.is_known()) return "no covariance to judge it by";
  return Format("%.2g %% by chance", 100.0 * significance.probability);
}

}  // namespace

CameraImuComparison CompareCameraImuResults(const Value& first, const Value& first_chain,
                                            const Value& second, const Value& second_chain) {
  const ResultParameters a = ParametersOf(first, &first_chain);
  const ResultParameters b = ParametersOf(second, &second_chain);
  const Value::Elements& first_cameras = first.At("cameras").elements();
  const Value::Elements& second_cameras = second.At("cameras").elements();
  if (first_cameras.size() != second_cameras.size()) {
    throw InputError({"the results are of different rigs", "",
                      std::to_string(first_cameras.size()) + " and " +
                          std::to_string(second_cameras.size()) + " cameras",
                      "compare results of the same cameras"});
  }
  CameraImuComparison comparison;
  for (const ParameterGroup& group : a.groups) {
    const ParameterGroup* other = b.Find(group.name);
    if (other == nullptr || other->names != group.names) continue;
    CameraImuComparison::Group compared{
        group.name, group.names, other->DifferenceTo(group), {}, {}};
    if (a.covariance.size() != 0 && b.covariance.size() != 0) {
      const Eigen::MatrixXd covariance =
          a.CovarianceOf({group.name}) + b.CovarianceOf({group.name});
      compared.sigma = covariance.diagonal().cwiseSqrt();
      compared.significance = SignificanceOf(compared.difference, covariance);
    }
    comparison.groups.push_back(std::move(compared));
  }
  const std::vector<Camera> first_models = CameraChainFromValue(first_chain, nullptr);
  const std::vector<Camera> second_models = CameraChainFromValue(second_chain, nullptr);
  for (size_t n = 0; n < first_cameras.size(); ++n) {
    const std::string name = "cam" + std::to_string(n);
    if (!(first_models[n].resolution == second_models[n].resolution)) {
      throw InputError({"the images differ in size", name, "the chains say different resolutions",
                        "compare results of one camera at one resolution"});
    }
    const CameraCalibrationState state = StateOf(first_models[n], first_cameras[n]);
    CameraImuComparison::Camera camera;
    camera.name = name;
    camera.difference_px = PredictionErrorPx(StateOf(second_models[n], second_cameras[n]), state,
                                             first_models[n].resolution);
    if (a.covariance.size() != 0 && b.covariance.size() != 0) {
      const CameraPart part = PartOfCamera(a, b, name);
      camera.expected_px = ExpectedPredictionErrorPx(state, first_models[n].resolution,
                                                     part.columns, part.covariance);
    }
    comparison.cameras.push_back(camera);
  }
  return comparison;
}

Agreement AgreementOf(const CameraImuComparison& comparison, double level) {
  const double limit = level / static_cast<double>(comparison.groups.size());
  const auto differs = [&](const auto& group) { return group.significance.probability < limit; };
  const auto is_known = [](const auto& group) { return group.significance.is_known(); };
  const auto& groups = comparison.groups;
  if (std::any_of(groups.begin(), groups.end(), differs)) return Agreement::kDiffer;
  return std::all_of(groups.begin(), groups.end(), is_known) ? Agreement::kAgree
                                                             : Agreement::kInconclusive;
}

Value ComparisonResult(const CameraImuComparison& comparison, double level) {
  Value cameras = Value::Array();
  for (const auto& camera : comparison.cameras) {
    cameras.Append(Value::Object()
                       .Set("name", camera.name)
                       .Set("difference_px", camera.difference_px)
                       .Set("expected_difference_px", camera.expected_px));
  }
  Value groups = Value::Array();
  for (const auto& group : comparison.groups) {
    Value parameters = Value::Array();
    for (size_t k = 0; k < group.names.size(); ++k) {
      const auto index = static_cast<Eigen::Index>(k);
      Value parameter = Value::Object();
      parameter.Set("name", group.names[k]).Set("difference", group.difference(index));
      if (group.sigma.size() != 0) parameter.Set("sigma", group.sigma(index));
      parameters.Append(std::move(parameter));
    }
    groups.Append(Value::Object()
                      .Set("name", group.name)
                      .Set("probability", group.significance.probability)
                      .Set("statistic", group.significance.statistic)
                      .Set("degrees_of_freedom", group.significance.degrees)
                      .Set("parameters", std::move(parameters)));
  }
  Value result = Value::Object();
  result.Set("kind", "diff")
      .Set("of", "camera-imu")
      .Set("agreement", AgreementName(AgreementOf(comparison, level)))
      .Set("level", level)
      .Set("cameras", std::move(cameras))
      .Set("groups", std::move(groups));
  return result;
}

std::string ComparisonText(const CameraImuComparison& comparison, double level) {
  std::string text;
  for (const auto& camera : comparison.cameras) {
    text += Format("%s  apart by %.3f px", camera.name.c_str(), camera.difference_px);
    if (!std::isnan(camera.expected_px)) text += Format(" (%.3f px expected)", camera.expected_px);
    text += " at 1 rad/s, from 0.5 m to infinity\n";
  }
  for (const auto& group : comparison.groups) {
    text += group.name + "  as far apart: " + Chance(group.significance) + "\n";
    for (size_t k = 0; k < group.names.size(); ++k) {
      const auto index = static_cast<Eigen::Index>(k);
      text += Format("  %-24s %+.3e", group.names[k].c_str(), group.difference(index));
      // What both held has no sigma.
      if (group.sigma.size() != 0 && group.sigma(index) > 0.0) {
        text += Format("  (%.1f sigma)", std::abs(group.difference(index)) / group.sigma(index));
      }
      text += "\n";
    }
  }
  return text + AgreementText(AgreementOf(comparison, level)) + "\n";
}

}  // namespace calibrato
