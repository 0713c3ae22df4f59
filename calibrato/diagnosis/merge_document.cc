#include "calibrato/diagnosis/merge_document.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

const ParameterGroup* Find(const MergedCalibration& merged, const std::string& name) {
  for (const MergedCalibration::Group& group : merged.groups) {
    if (group.merged.name == name) return &group.merged;
  }
  return nullptr;
}

Rigid3 PoseOf(const ParameterGroup& group) {
  return {group.rotations.front().second, group.values.tail<3>()};
}

// What the group has, by its names; the rest as it was.
ImuIntrinsics IntrinsicsOf(const ParameterGroup& group, ImuIntrinsics intrinsics) {
  constexpr const char* kAxes = "xyz";
  const auto at = [&](const std::string& name, double otherwise) {
    for (size_t k = 0; k < group.names.size(); ++k) {
      if (group.names[k].ends_with("." + name)) return group.values(static_cast<Eigen::Index>(k));
    }
    return otherwise;
  };
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const std::string entry = {kAxes[row], kAxes[column]};
      double& accel = intrinsics.M_accel(row, column);
      double& gyro = intrinsics.M_gyro(row, column);
      double& force = intrinsics.g_sensitivity(row, column);
      accel = at("M_accel_" + entry, accel);
      gyro = at("M_gyro_" + entry, gyro);
      force = at("g_sensitivity_" + entry, force);
    }
    for (int axis = 1; axis < 3; ++axis) {
      double& arm = intrinsics.lever_arms_i(row, axis);
      arm = at(std::string("lever_arm_") + kAxes[axis] + "_" + kAxes[row], arm);
    }
  }
  if (!group.rotations.empty()) intrinsics.R_gyro_i = group.rotations.front().second;
  return intrinsics;
}

// A folder may hold a result of one run beside the chain or the IMUs of another.
void CheckFiles(const ResultFolder& folder, const std::string& kind) {
  const auto check = [&](const char* key, const std::string& file, size_t in_file) {
    const size_t in_result = folder.result.At(key).size();
    if (in_result == in_file) return;
    throw InputError({"result.json and " + file + " are not of one calibration", folder.name,
                      std::to_string(in_result) + " and " + std::to_string(in_file) + " " + key,
                      "calibrate again"});
  };
  const bool has_imu = kind == "camera-imu";
  check("cameras", has_imu ? "camchain-imucam.yaml" : "camchain.yaml",
        CameraChainFromValue(folder.chain, nullptr).size());
  if (has_imu) check("imus", "imu.yaml", ImusFromValue(folder.imus, nullptr).size());
}

bool AreSameCameras(const std::vector<Camera>& a, const std::vector<Camera>& b) {
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(), [](const Camera& one, const Camera& other) {
        return one.model.name() == other.model.name() && one.resolution == other.resolution;
      });
}

void CheckSameCameras(const std::vector<ResultFolder>& folders) {
  const std::vector<Camera> first = CameraChainFromValue(folders.front().chain, nullptr);
  for (const ResultFolder& folder : folders) {
    if (AreSameCameras(first, CameraChainFromValue(folder.chain, nullptr))) continue;
    throw InputError(
        {"the results are of different cameras", folder.name,
         "their number, a model or a resolution is not that of " + folders.front().name,
         "merge calibrations of one rig, with the same models and images of one size"});
  }
}

// @pre the same cameras
bool HaveSameLenses(const std::vector<Camera>& a, const std::vector<Camera>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Camera& one, const Camera& other) {
                      return one.model.parameters() == other.model.parameters();
                    });
}

// Extrinsics depend on the lens: where it was given, it must have been the same.
void CheckHeldLenses(const std::vector<ResultFolder>& folders, const MergedCalibration& merged) {
  if (Find(merged, "cam0 lens") != nullptr) return;
  const std::vector<Camera> first = CameraChainFromValue(folders.front().chain, nullptr);
  for (const ResultFolder& folder : folders) {
    if (HaveSameLenses(first, CameraChainFromValue(folder.chain, nullptr))) continue;
    throw InputError({"the results are of different lenses", folder.name,
                      "its cameras' intrinsics are not those of " + folders.front().name,
                      "calibrate all recordings with the same --cameras"});
  }
}

Eigen::Vector3d MeanOf(const std::vector<ResultFolder>& folders, size_t imu, const char* key) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ResultFolder& folder : folders) {
    sum += Eigen::Vector3d(folder.result.At("imus").elements()[imu].At(key).AsDoubles(3).data());
  }
  return sum / static_cast<double>(folders.size());
}

Value NumberOrNull(double number) { return std::isfinite(number) ? Value(number) : Value(); }

Value GroupValue(const MergedCalibration::Group& group, const Eigen::VectorXd& merged_sigma) {
  Value parameters = Value::Array();
  const ParameterGroup& merged = group.merged;
  for (Eigen::Index k = 0; k < merged.size(); ++k) {
    bool is_turn = false;
    for (const auto& rotation : merged.rotations) {
      is_turn = is_turn || (k >= rotation.first && k < rotation.first + 3);
    }
    const Eigen::VectorXd deviations = group.deviations.row(k);
    const Eigen::VectorXd sigmas = group.sigmas.row(k);
    parameters.Append(Value::Object()
                          .Set("name", merged.names[static_cast<size_t>(k)])
                          .Set("value", is_turn ? Value() : Value(merged.values(k)))
                          .Set("sigma", merged_sigma(k))
                          .Set("repeatability", group.repeatability(k))
                          .Set("stated_sigma", std::sqrt(sigmas.squaredNorm() / sigmas.size()))
                          .Set("deviations", Value::Numbers(deviations))
                          .Set("sigmas", Value::Numbers(sigmas)));
  }
  return Value::Object()
      .Set("name", merged.name)
      // A group that was held does not scatter.
      .Set("probability", NumberOrNull(group.scatter.probability))
      .Set("statistic", NumberOrNull(group.scatter.statistic))
      .Set("degrees_of_freedom", NumberOrNull(group.scatter.degrees))
      .Set("sigma_scale", group.sigma_scale)
      .Set("parameters", std::move(parameters));
}

Value CovarianceValue(const MergedCalibration& merged) {
  Value names = Value::Array();
  for (const MergedCalibration::Group& group : merged.groups) {
    for (const std::string& name : group.merged.names) names.Append(name);
  }
  Value matrix = Value::Array();
  for (Eigen::Index row = 0; row < merged.covariance.rows(); ++row) {
    matrix.Append(Value::Numbers(Eigen::VectorXd(merged.covariance.row(row))));
  }
  return Value::Object().Set("names", std::move(names)).Set("matrix", std::move(matrix));
}

Value LensValue(const Camera& camera, const Eigen::VectorXd& sigma) {
  const Eigen::VectorXd intrinsics = camera.model.intrinsics();
  const Eigen::VectorXd distortion = camera.model.distortion();
  Value resolution = Value::Array();
  resolution.Append(camera.resolution.width).Append(camera.resolution.height);
  return Value::Object()
      .Set("model", std::string(camera.model.name()))
      .Set("resolution", std::move(resolution))
      .Set("intrinsics", Value::Numbers(intrinsics))
      .Set("distortion", Value::Numbers(distortion))
      .Set("intrinsics_sigma", Value::Numbers(Eigen::VectorXd(sigma.head(intrinsics.size()))))
      .Set("distortion_sigma", Value::Numbers(Eigen::VectorXd(sigma.tail(distortion.size()))))
      .Set("T_cn_cnm1", camera.T_cn_cnm1 ? ToValue(*camera.T_cn_cnm1) : Value());
}

Value ImusValue(const std::vector<ResultFolder>& folders, const MergedCalibration& merged,
                const std::vector<Imu>& imus) {
  Value values = Value::Array();
  for (size_t n = 0; n < imus.size(); ++n) {
    Value imu = Value::Object();
    imu.Set("model", ImuModelName(imus[n].model))
        .Set("gyro_bias", Value::Numbers(MeanOf(folders, n, "gyro_bias")))
        .Set("accel_bias", Value::Numbers(MeanOf(folders, n, "accel_bias")))
        .Set("T_i_imu", ToValue(imus[n].T_i_b.Inverse()));
    const ParameterGroup* offset = Find(merged, "imu" + std::to_string(n) + " time offset");
    imu.Set("time_offset_s", offset == nullptr ? 0.0 : offset->values(0));
    SetImuIntrinsics(imus[n].intrinsics, imus[n].model, &imu);
    values.Append(std::move(imu));
  }
  return values;
}

std::vector<Finding> AllFindings(const std::vector<ResultFolder>& folders,
                                 const MergedCalibration& merged) {
  std::vector<Finding> findings = FindingsOf(merged);
  const bool has_imu = CalibrationKind(folders.front().result) == "camera-imu";
  if (has_imu && Find(merged, "cam0 lens") != nullptr) {
    findings.push_back(
        {Severity::kInfo,
         "the lens was estimated along in every recording: a lens calibration that all started "
         "from counts once for each",
         "its part of the sigmas is too small by up to the root of their number; hold the lens by "
         "--cameras to keep it apart"});
  }
  for (const ResultFolder& folder : folders) {
    const Value* verdict = folder.result.Find("verdict");
    if (verdict == nullptr) continue;
    const std::string name = verdict->AsString();
    if (name != "fail" && name != "inconclusive") continue;
    findings.insert(findings.begin(), {name == "fail" ? Severity::kFail : Severity::kInconclusive,
                                       "the verdict of " + folder.name + " is " + name,
                                       "leave it out, or see in its report why"});
  }
  return findings;
}

}  // namespace

MergedDocuments MergeResults(const std::vector<ResultFolder>& folders) {
  if (folders.empty()) throw InputError({"nothing to merge", "", "no result was given", ""});
  const std::string kind = CalibrationKind(folders.front().result);
  std::vector<ResultParameters> results;
  std::vector<std::string> names;
  for (const ResultFolder& folder : folders) {
    if (CalibrationKind(folder.result) != kind) {
      throw InputError({"the results are of different kinds", folder.name,
                        "it is of " + CalibrationKind(folder.result) + ", " + folders.front().name +
                            " of " + kind,
                        "merge cameras with cameras, and cameras with an IMU with such"});
    }
    results.push_back(ParametersOf(folder.result, &folder.chain));
    CheckFiles(folder, kind);
    names.push_back(folder.name);
  }
  CheckSameCameras(folders);
  const MergedCalibration merged = MergeCalibrations(results, names);
  const bool has_imu = kind == "camera-imu";
  if (has_imu) CheckHeldLenses(folders, merged);

  std::vector<Camera> cameras = CameraChainFromValue(folders.front().chain, nullptr);
  const Eigen::VectorXd sigma = merged.covariance.diagonal().cwiseSqrt();
  Value groups = Value::Array();
  std::vector<Eigen::VectorXd> group_sigmas;
  Eigen::Index begin = 0;
  for (const MergedCalibration::Group& group : merged.groups) {
    group_sigmas.emplace_back(sigma.segment(begin, group.merged.size()));
    groups.Append(GroupValue(group, group_sigmas.back()));
    begin += group.merged.size();
  }
  const auto sigma_of = [&](const std::string& name) {
    for (size_t g = 0; g < merged.groups.size(); ++g) {
      if (merged.groups[g].merged.name == name) return group_sigmas[g];
    }
    return Eigen::VectorXd();
  };
  Value in_result = Value::Array();
  MergedDocuments documents;
  std::vector<Rigid3> T_c_i;
  for (size_t n = 0; n < cameras.size(); ++n) {
    const std::string name = "cam" + std::to_string(n);
    if (const ParameterGroup* lens = Find(merged, name + " lens")) {
      cameras[n].model = CameraModel(cameras[n].model.name(), lens->values);
    }
    const ParameterGroup* pose = Find(merged, name + " pose");
    if (!has_imu) {
      cameras[n].T_cn_cnm1 = pose == nullptr ? std::nullopt : std::optional<Rigid3>(PoseOf(*pose));
      in_result.Append(LensValue(cameras[n], sigma_of(name + " lens")));
      continue;
    }
    T_c_i.push_back(PoseOf(*pose));
    if (n > 0) cameras[n].T_cn_cnm1 = T_c_i[n] * T_c_i[n - 1].Inverse();
    Value camera = Value::Object();
    const ParameterGroup* offset = Find(merged, name + " time offset");
    camera.Set("T_cam_imu", ToValue(T_c_i[n]))
        .Set("time_offset_s",
             offset != nullptr
                 ? Value(offset->values(0))
                 : folders.front().result.At("cameras").elements()[n].At("time_offset_s"));
    if (const ParameterGroup* delay = Find(merged, name + " line delay")) {
      camera.Set("line_delay_s", delay->values(0));
    }
    in_result.Append(std::move(camera));
  }
  documents.chain = ToValue(cameras);
  const std::vector<Finding> findings = AllFindings(folders, merged);
  Value result_names = Value::Array();
  for (const std::string& name : names) result_names.Append(name);
  documents.result.Set("kind", "merge")
      .Set("of", kind)
      .Set("verdict", VerdictName(VerdictOf(findings)))
      .Set("findings", ToValue(findings))
      .Set("results", std::move(result_names));
  if (has_imu) {
    for (size_t n = 0; n < cameras.size(); ++n) {
      const std::string name = "cam" + std::to_string(n);
      Value camera = documents.chain.At(name);
      camera.Set("T_cam_imu", ToValue(T_c_i[n]))
          .Set("timeshift_cam_imu", in_result.elements()[n].At("time_offset_s").AsDouble());
      documents.chain.Set(name, std::move(camera));
    }
    std::vector<Imu> imus = ImusFromValue(folders.front().imus, nullptr);
    for (size_t n = 0; n < imus.size(); ++n) {
      const std::string name = "imu" + std::to_string(n);
      if (const ParameterGroup* pose = Find(merged, name + " pose")) {
        imus[n].T_i_b = PoseOf(*pose).Inverse();
      }
      if (const ParameterGroup* offset = Find(merged, name + " time offset")) {
        imus[n].time_offset = Duration::FromSeconds(offset->values(0));
      }
      if (const ParameterGroup* axes = Find(merged, name + " axes")) {
        imus[n].intrinsics = IntrinsicsOf(*axes, imus[n].intrinsics);
      }
    }
    documents.imus = ToValue(imus);
    documents.result.Set("imus", ImusValue(folders, merged, imus))
        .Set("gravity_g", folders.front().result.At("gravity_g"));
  }
  documents.result.Set("cameras", std::move(in_result))
      .Set("covariance", CovarianceValue(merged))
      .Set("groups", std::move(groups));
  return documents;
}

std::string MergeText(const Value& result) {
  std::string text = Format("merged from %zu results\n", result.At("results").size());
  for (const Value& group : result.At("groups").elements()) {
    const Value* probability = group.Find("probability");
    text += group.At("name").AsString();
    if (probability != nullptr) {
      text += Format("  as scattered: %.2g %% by chance", 100.0 * probability->AsDouble());
    }
    text += "\n";
    for (const Value& parameter : group.At("parameters").elements()) {
      const Value* value = parameter.Find("value");
      text += Format("  %-24s %14s +- %.3e  repeats to %.3e, stated %.3e\n",
                     parameter.At("name").AsString().c_str(),
                     value == nullptr ? "" : Format("%.6g", value->AsDouble()).c_str(),
                     parameter.At("sigma").AsDouble(), parameter.At("repeatability").AsDouble(),
                     parameter.At("stated_sigma").AsDouble());
    }
  }
  text += "verdict: " + result.At("verdict").AsString() + "\n";
  for (const Value& finding : result.At("findings").elements()) {
    text += "  - " + finding.At("what").AsString() + "; " + finding.At("remedy").AsString() + "\n";
  }
  return text;
}

}  // namespace calibrato
