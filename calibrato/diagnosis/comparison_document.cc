#include "calibrato/diagnosis/comparison_document.h"

#include <algorithm>

#include "calibrato/base/input_error.h"
#include "calibrato/diagnosis/checks_document.h"
#include "calibrato/diagnosis/finding.h"
#include "calibrato/diagnosis/result_parameters.h"
#include "calibrato/sensors/camera_chain.h"

namespace calibrato {
namespace {

struct NamedCovariance {
  std::vector<std::string> names;
  Eigen::MatrixXd matrix;

  // The block of these names; empty where one is missing.
  Eigen::MatrixXd Block(const std::vector<std::string>& wanted) const {
    std::vector<Eigen::Index> indices;
    for (const std::string& name : wanted) {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end()) return {};
      indices.push_back(found - names.begin());
    }
    return matrix(indices, indices);
  }
};

NamedCovariance ReadCovariance(const Value& result) {
  NamedCovariance covariance;
  const Value* value = result.Find("covariance");
  if (value == nullptr) return covariance;
  for (const Value& name : value->At("names").elements()) {
    covariance.names.push_back(name.AsString());
  }
  const auto size = static_cast<Eigen::Index>(covariance.names.size());
  const std::vector<double> entries =
      value->At("matrix").AsDoubles(covariance.names.size() * covariance.names.size());
  covariance.matrix = Eigen::Map<const Eigen::MatrixXd>(entries.data(), size, size);
  return covariance;
}

std::vector<std::string> Prefixed(const std::string& camera,
                                  const std::vector<std::string>& names) {
  std::vector<std::string> prefixed;
  for (const std::string& name : names) prefixed.push_back(camera + "." + name);
  return prefixed;
}

CameraEstimate ReadCamera(const Value& value, const std::string& name,
                          const NamedCovariance& covariance) {
  const std::string model = value.At("model").AsString();
  if (value.Find("intrinsics") == nullptr) {
    value.Fail("nothing to compare", "this camera was not calibrated", "calibrate it again");
  }
  std::vector<double> parameters = value.At("intrinsics").AsDoubles();
  const std::vector<double> distortion = value.At("distortion").AsDoubles();
  parameters.insert(parameters.end(), distortion.begin(), distortion.end());
  const std::vector<double> size = value.At("resolution").AsDoubles(2);
  return {CameraModel(model, Eigen::Map<const Eigen::VectorXd>(
                                 parameters.data(), static_cast<Eigen::Index>(parameters.size()))),
          {static_cast<int>(size[0]), static_cast<int>(size[1])},
          covariance.Block(Prefixed(name, CameraModel::ParameterNames(model)))};
}

const Value::Elements& Cameras(const Value& result) {
  if (CalibrationKind(result) != "camera") {
    result.At("kind").Fail("cannot compare these results",
                           "one is of a camera, one of a camera-imu",
                           "give two --out folders of the same command");
  }
  return result.At("cameras").elements();
}

std::vector<const Significance*> Tests(const ResultComparison& comparison) {
  std::vector<const Significance*> tests;
  for (const auto& pair : comparison.cameras) {
    tests.push_back(&pair.camera.significance);
    const Significance& focal = pair.camera.focal_change.significance;
    if (focal.is_known()) tests.push_back(&focal);
    if (pair.T_cn_cnm1) tests.push_back(&pair.T_cn_cnm1->significance);
  }
  return tests;
}

std::string Chance(const Significance& significance) {
  if (!significance.is_known()) return "no covariance to judge it by";
  return Format("%.2g %% by chance", 100.0 * significance.probability);
}

}  // namespace

std::string AgreementName(Agreement agreement) {
  switch (agreement) {
    case Agreement::kAgree:
      return "agree";
    case Agreement::kDiffer:
      return "differ";
    case Agreement::kInconclusive:
      return "inconclusive";
  }
  return "";
}

ResultComparison CompareResults(const Value& first, const Value& second) {
  const Value::Elements& first_cameras = Cameras(first);
  const Value::Elements& second_cameras = Cameras(second);
  if (first_cameras.size() != second_cameras.size()) {
    throw InputError({"the results are of different rigs", "",
                      std::to_string(first_cameras.size()) + " and " +
                          std::to_string(second_cameras.size()) + " cameras",
                      "compare results of the same cameras"});
  }
  const NamedCovariance first_covariance = ReadCovariance(first);
  const NamedCovariance second_covariance = ReadCovariance(second);
  ResultComparison comparison;
  for (size_t c = 0; c < first_cameras.size(); ++c) {
    const std::string name = "cam" + std::to_string(c);
    const CameraEstimate a = ReadCamera(first_cameras[c], name, first_covariance);
    const CameraEstimate b = ReadCamera(second_cameras[c], name, second_covariance);
    ResultComparison::CameraPair pair;
    pair.name = name;
    pair.first_model = a.model.name();
    pair.second_model = b.model.name();
    pair.resolution = a.resolution;
    pair.camera = CompareCameras(a, b);
    const Value* T_a = first_cameras[c].Find("T_cn_cnm1");
    const Value* T_b = second_cameras[c].Find("T_cn_cnm1");
    if (T_a != nullptr && T_b != nullptr) {
      const std::vector<std::string> names =
          Prefixed(name, {"rot_x", "rot_y", "rot_z", "pos_x", "pos_y", "pos_z"});
      pair.T_cn_cnm1 = ComparePoses(Rigid3FromValue(*T_a), first_covariance.Block(names),
                                    Rigid3FromValue(*T_b), second_covariance.Block(names));
    }
    comparison.cameras.push_back(std::move(pair));
  }
  return comparison;
}

std::string AgreementText(Agreement agreement) {
  switch (agreement) {
    case Agreement::kAgree:
      return "the results agree";
    case Agreement::kDiffer:
      return "the results differ by more than chance";
    case Agreement::kInconclusive:
      return "inconclusive: a result has no covariance";
  }
  return "";
}

Agreement AgreementOf(const ResultComparison& comparison, double level) {
  const std::vector<const Significance*> tests = Tests(comparison);
  const double limit = level / static_cast<double>(tests.size());
  const auto differs = [&](const Significance* test) { return test->probability < limit; };
  const auto is_known = [](const Significance* test) { return test->is_known(); };
  if (std::any_of(tests.begin(), tests.end(), differs)) return Agreement::kDiffer;
  return std::all_of(tests.begin(), tests.end(), is_known) ? Agreement::kAgree
                                                           : Agreement::kInconclusive;
}

Value ComparisonResult(const ResultComparison& comparison, double level) {
  Value cameras = Value::Array();
  for (const auto& pair : comparison.cameras) {
    const CameraComparison& camera = pair.camera;
    Value value = Value::Object();
    value.Set("name", pair.name)
        .Set("models", Value::Array().Append(pair.first_model).Append(pair.second_model))
        .Set("resolution",
             Value::Array().Append(pair.resolution.width).Append(pair.resolution.height))
        .Set("probability", camera.significance.probability)
        .Set("statistic", camera.significance.statistic)
        .Set("degrees_of_freedom", camera.significance.degrees)
        .Set("tested", camera.by_parameters ? "parameters" : "projection")
        .Set("focal_change", camera.focal_change.relative)
        .Set("focal_change_sigma", camera.focal_change.sigma)
        .Set("focal_change_probability", camera.focal_change.significance.probability)
        .Set("rms_difference_px", camera.rms_px)
        .Set("expected_rms_difference_px", camera.expected_rms_px)
        .Set("rotation_rad", Value::Numbers(camera.rotation))
        .Set("difference_px", ToValue(camera.difference_px));
    if (pair.T_cn_cnm1) {
      Value pose = Value::Object();
      pose.Set("rotation_rad", pair.T_cn_cnm1->rotation_rad)
          .Set("translation_m", pair.T_cn_cnm1->translation_m)
          .Set("probability", pair.T_cn_cnm1->significance.probability);
      value.Set("T_cn_cnm1", std::move(pose));
    }
    cameras.Append(std::move(value));
  }
  Value result = Value::Object();
  result.Set("kind", "diff")
      .Set("agreement", AgreementName(AgreementOf(comparison, level)))
      .Set("level", level)
      .Set("cameras", std::move(cameras));
  return result;
}

std::string ComparisonText(const ResultComparison& comparison, double level) {
  std::string text;
  for (const auto& pair : comparison.cameras) {
    const CameraComparison& camera = pair.camera;
    text += pair.name + "  " + pair.first_model;
    if (pair.second_model != pair.first_model) text += " and " + pair.second_model;
    text += Format("\n  apart by %.3f px (median), %.3f px (worst), %.3f px (rms",
                   camera.difference_px.median, camera.difference_px.worst, camera.rms_px);
    if (camera.significance.is_known()) {
      text += Format("; %.3f px expected", camera.expected_rms_px);
    }
    text += Format("), after a turn by %.2f mrad\n", 1e3 * camera.rotation.norm());
    text += std::string("  ") + (camera.by_parameters ? "parameters" : "projection") +
            " as far apart: " + Chance(camera.significance) + "\n";
    if (camera.focal_change.significance.is_known()) {
      text += Format("  if only the focal length changed, by %.4f %% (+- %.4f): ",
                     100.0 * camera.focal_change.relative, 100.0 * camera.focal_change.sigma) +
              Chance(camera.focal_change.significance) + "\n";
    }
    if (pair.T_cn_cnm1) {
      text +=
          Format("  T_cn_cnm1 apart by %.2f mrad and %.2f mm: ", 1e3 * pair.T_cn_cnm1->rotation_rad,
                 1e3 * pair.T_cn_cnm1->translation_m) +
          Chance(pair.T_cn_cnm1->significance) + "\n";
    }
  }
  return text + AgreementText(AgreementOf(comparison, level)) + "\n";
}

}  // namespace calibrato
