#include "calibrato/diagnosis/result_parameters.h"

#include <algorithm>
#include <array>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

const std::vector<std::string> kPoseNames = {"rot_x", "rot_y", "rot_z", "pos_x", "pos_y", "pos_z"};

struct NamedMatrix {
  std::vector<std::string> names;
  Eigen::MatrixXd matrix;

  [[nodiscard]] bool Has(const std::string& name) const {
    return std::find(names.begin(), names.end(), name) != names.end();
  }
};

NamedMatrix ReadCovariance(const Value& result) {
  NamedMatrix covariance;
  const Value* value = result.Find("covariance");
  if (value == nullptr) return covariance;
  for (const Value& name : value->At("names").elements()) {
    covariance.names.push_back(name.AsString());
  }
  const auto size = static_cast<Eigen::Index>(covariance.names.size());
  if (size == 0) return covariance;
  const std::vector<double> entries =
      value->At("matrix").AsDoubles(covariance.names.size() * covariance.names.size());
  covariance.matrix = Eigen::Map<const Eigen::MatrixXd>(entries.data(), size, size);
  return covariance;
}

std::vector<std::string> Prefixed(const std::string& sensor,
                                  const std::vector<std::string>& names) {
  std::vector<std::string> prefixed;
  for (const std::string& name : names) prefixed.push_back(sensor + "." + name);
  return prefixed;
}

ParameterGroup PoseGroup(const std::string& sensor, const Rigid3& T) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(6);
  values.tail<3>() = T.t;
  return {sensor + " pose", Prefixed(sensor, kPoseNames), values, {{0, T.R}}};
}

ParameterGroup LensGroup(const std::string& sensor, const CameraModel& model) {
  return {sensor + " lens", Prefixed(sensor, CameraModel::ParameterNames(model.name())),
          model.parameters()};
}

ParameterGroup NumberGroup(const std::string& sensor, const std::string& what,
                           const std::string& name, double value) {
  return {sensor + " " + what, {sensor + "." + name}, Eigen::VectorXd::Constant(1, value)};
}

CameraModel ModelOf(const Value& camera) {
  if (camera.Find("intrinsics") == nullptr) {
    camera.Fail("nothing to compare", "this camera was not calibrated", "calibrate it again");
  }
  std::vector<double> parameters = camera.At("intrinsics").AsDoubles();
  const std::vector<double> distortion = camera.At("distortion").AsDoubles();
  parameters.insert(parameters.end(), distortion.begin(), distortion.end());
  return {camera.At("model").AsString(),
          Eigen::Map<const Eigen::VectorXd>(parameters.data(),
                                            static_cast<Eigen::Index>(parameters.size()))};
}

// M_accel, M_gyro (lower triangles by rows), R_gyro_i, g_sensitivity, lever arms of y and z: in the
// order and by the names of the covariance (calibration/camera_imu_layout.h), as far as it has
// them.
ParameterGroup AxesGroup(const std::string& sensor, const ImuIntrinsics& imu,
                         const NamedMatrix& covariance) {
  ParameterGroup group{sensor + " axes", {}, {}, {}};
  std::vector<double> values;
  const auto add = [&](const std::string& name, double value) {
    if (!covariance.Has(sensor + "." + name)) return;
    group.names.push_back(sensor + "." + name);
    values.push_back(value);
  };
  constexpr const char* kAxes = "xyz";
  const auto add_matrix = [&](const std::string& name, const Eigen::Matrix3d& M, bool is_lower) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < (is_lower ? row + 1 : 3); ++column) {
        add(name + kAxes[row] + kAxes[column], M(row, column));
      }
    }
  };
  add_matrix("M_accel_", imu.M_accel, true);
  add_matrix("M_gyro_", imu.M_gyro, true);
  if (covariance.Has(sensor + ".R_gyro_i_x")) {
    group.rotations.emplace_back(static_cast<Eigen::Index>(values.size()), imu.R_gyro_i);
  }
  for (int k = 0; k < 3; ++k) add(std::string("R_gyro_i_") + kAxes[k], 0.0);
  add_matrix("g_sensitivity_", imu.g_sensitivity, false);
  for (int axis = 1; axis < 3; ++axis) {
    for (int k = 0; k < 3; ++k) {
      add(std::string("lever_arm_") + kAxes[axis] + "_" + kAxes[k], imu.lever_arms_i(k, axis));
    }
  }
  group.values =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return group;
}

void AddCamera(const Value& camera, const std::string& name, std::vector<ParameterGroup>* groups) {
  groups->push_back(LensGroup(name, ModelOf(camera)));
  const Value* T = camera.Find("T_cn_cnm1");
  if (T != nullptr) groups->push_back(PoseGroup(name, Rigid3FromValue(*T)));
}

void AddCameraOnImu(const Value& camera, const std::string& name, const Camera& in_chain,
                    const NamedMatrix& covariance, std::vector<ParameterGroup>* groups) {
  groups->push_back(PoseGroup(name, Rigid3FromValue(camera.At("T_cam_imu"))));
  if (covariance.Has(name + ".time_offset") || covariance.names.empty()) {
    groups->push_back(
        NumberGroup(name, "time offset", "time_offset", camera.At("time_offset_s").AsDouble()));
  }
  if (covariance.Has(name + ".line_delay")) {
    groups->push_back(
        NumberGroup(name, "line delay", "line_delay", camera.At("line_delay_s").AsDouble()));
  }
  if (covariance.Has(name + ".fu")) groups->push_back(LensGroup(name, in_chain.model));
}

void AddImu(const Value& imu, size_t index, const NamedMatrix& covariance,
            std::vector<ParameterGroup>* groups) {
  const std::string name = "imu" + std::to_string(index);
  if (index > 0) {
    groups->push_back(PoseGroup(name, Rigid3FromValue(imu.At("T_i_imu"))));
    groups->push_back(
        NumberGroup(name, "time offset", "time_offset", imu.At("time_offset_s").AsDouble()));
  }
  ParameterGroup axes = AxesGroup(name, ImuIntrinsicsFromValue(imu, nullptr), covariance);
  if (axes.size() > 0) groups->push_back(std::move(axes));
}

}  // namespace

Eigen::VectorXd ParameterGroup::DifferenceTo(const ParameterGroup& from) const {
  Eigen::VectorXd delta = values - from.values;
  for (size_t k = 0; k < rotations.size(); ++k) {
    delta.segment<3>(rotations[k].first) =
        LogSo3(rotations[k].second * from.rotations[k].second.transpose());
  }
  return delta;
}

ParameterGroup ParameterGroup::Perturbed(const Eigen::VectorXd& delta) const {
  ParameterGroup result = *this;
  result.values += delta;
  for (auto& [index, R] : result.rotations) {
    R = ExpSo3(delta.segment<3>(index)) * R;
    result.values.segment<3>(index).setZero();
  }
  return result;
}

const ParameterGroup* ResultParameters::Find(const std::string& group) const {
  const auto found = std::find_if(groups.begin(), groups.end(),
                                  [&](const ParameterGroup& one) { return one.name == group; });
  return found == groups.end() ? nullptr : &*found;
}

Eigen::MatrixXd ResultParameters::CovarianceOf(const std::vector<std::string>& group_names) const {
  if (covariance.size() == 0) return {};
  std::vector<Eigen::Index> indices;
  for (const std::string& name : group_names) {
    Eigen::Index begin = 0;
    for (const ParameterGroup& group : groups) {
      if (group.name == name) {
        for (Eigen::Index k = 0; k < group.size(); ++k) indices.push_back(begin + k);
      }
      begin += group.size();
    }
  }
  return covariance(indices, indices);
}

std::string CalibrationKind(const Value& result) {
  const std::string kind = result.At("kind").AsString();
  const std::string of = kind == "merge" ? result.At("of").AsString() : kind;
  if (of != "camera" && of != "camera-imu") {
    result.At("kind").Fail("not a calibration", "it is a result of kind " + kind,
                           "give --out folders of calibrate camera or calibrate camera-imu");
  }
  return of;
}

ResultParameters ParametersOf(const Value& result, const Value* chain) {
  const std::string kind = CalibrationKind(result);
  if (result.Find("cameras") == nullptr) {
    result.At("kind").Fail("nothing to compare", "the result has no estimate",
                           "see its findings, and calibrate again");
  }
  const NamedMatrix covariance = ReadCovariance(result);
  const Value::Elements& cameras = result.At("cameras").elements();
  ResultParameters parameters;
  std::vector<Camera> in_chain;
  if (kind == "camera-imu") in_chain = CameraChainFromValue(*chain, nullptr);
  for (size_t n = 0; n < cameras.size(); ++n) {
    const std::string name = "cam" + std::to_string(n);
    if (kind == "camera") {
      AddCamera(cameras[n], name, &parameters.groups);
      continue;
    }
    if (n >= in_chain.size()) {
      cameras[n].Fail("result.json and camchain-imucam.yaml are not of one calibration",
                      "the chain has no " + name, "calibrate again");
    }
    AddCameraOnImu(cameras[n], name, in_chain[n], covariance, &parameters.groups);
  }
  if (kind == "camera-imu") {
    const Value::Elements& imus = result.At("imus").elements();
    for (size_t n = 0; n < imus.size(); ++n) AddImu(imus[n], n, covariance, &parameters.groups);
  }
  std::vector<Eigen::Index> indices;
  for (const ParameterGroup& group : parameters.groups) {
    for (const std::string& name : group.names) {
      const auto found = std::find(covariance.names.begin(), covariance.names.end(), name);
      if (found == covariance.names.end()) return parameters;
      indices.push_back(found - covariance.names.begin());
    }
  }
  parameters.covariance = covariance.matrix(indices, indices);
  return parameters;
}

}  // namespace calibrato
