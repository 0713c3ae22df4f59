#include "calibrato/sensors/camera_chain.h"

#include <Eigen/LU>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

// Kalibr splits a model's name into camera_model and distortion_model, and writes "equi" in full.
std::string ModelName(const Value& camera) {
  const std::string projection = camera.At("camera_model").AsString();
  std::string distortion = camera.At("distortion_model").AsString();
  if (distortion == "equidistant") distortion = "equi";
  return projection + "-" + distortion;
}

CameraModel ModelFromValue(const Value& camera) {
  const std::vector<double> intrinsics = camera.At("intrinsics").AsDoubles();
  const Value* coefficients = camera.Find("distortion_coeffs");
  std::vector<double> parameters = intrinsics;
  if (coefficients != nullptr) {
    const std::vector<double> distortion = coefficients->AsDoubles();
    parameters.insert(parameters.end(), distortion.begin(), distortion.end());
  }
  const std::string name = ModelName(camera);
  try {
    const auto num_intrinsics = static_cast<size_t>(CameraModel::NumIntrinsics(name));
    if (intrinsics.size() != num_intrinsics) {
      std::string order;
      for (size_t i = 0; i < num_intrinsics; ++i) {
        order += (i == 0 ? "" : " ") + CameraModel::ParameterNames(name)[i];
      }
      throw InputError({"wrong number of intrinsics for " + name, "",
                        "expected " + std::to_string(num_intrinsics) + ", got " +
                            std::to_string(intrinsics.size()),
                        "give " + order});
    }
    return {name, Eigen::Map<const Eigen::VectorXd>(parameters.data(),
                                                    static_cast<Eigen::Index>(parameters.size()))};
  } catch (const InputError& error) {
    camera.Fail("bad camera", error.what(), "see docs/camera-models.md");
  }
}

}  // namespace

Rigid3 Rigid3FromValue(const Value& value) {
  const std::vector<double> numbers = value.AsDoubles(16);
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const bool is_rotation =
      (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-3 && R.determinant() > 0.0;
  const bool is_homogeneous =
      (matrix.bottomRows<1>() - Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)).norm() < 1e-9;
  if (!is_rotation || !is_homogeneous) {
    value.Fail("not a rigid transform",
               is_homogeneous ? "the upper left 3x3 block is not a rotation"
                              : "the last row is not 0 0 0 1",
               "give a 4x4 matrix row by row, [R t; 0 0 0 1]");
  }
  // A rotation to all its digits is kept as it is, so that files read back to the same bytes.
  const bool is_exact =
      (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-14;
  return {is_exact ? R : NearestRotation(R), matrix.topRightCorner<3, 1>()};
}

Value ToValue(const Rigid3& T_a_b) {
  Value rows = Value::Array();
  const Eigen::Matrix4d matrix = T_a_b.Matrix();
  for (int row = 0; row < 4; ++row) {
    const Eigen::Vector4d numbers = matrix.row(row);
    rows.Append(Value::Numbers(numbers));
  }
  return rows;
}

std::vector<Camera> CameraChainFromValue(const Value& value, std::vector<std::string>* warnings) {
  std::vector<Camera> cameras;
  for (const auto& [name, entry] : value.members()) {
    if (name != "cam" + std::to_string(cameras.size())) {
      entry.Fail("unexpected key " + name,
                 "cameras are named cam0, cam1, .. in order, and cam" +
                     std::to_string(cameras.size()) + " comes next",
                 "rename it");
    }
    if (warnings != nullptr) {
      const std::vector<std::string> unknown = entry.UnknownKeys(
          {"camera_model", "intrinsics", "distortion_model", "distortion_coeffs", "resolution",
           "rostopic", "T_cn_cnm1", "cam_overlaps", "T_cam_imu", "timeshift_cam_imu"});
      warnings->insert(warnings->end(), unknown.begin(), unknown.end());
    }
    const CameraModel model = ModelFromValue(entry);
    const std::vector<double> size = entry.At("resolution").AsDoubles(2);
    if (!(size[0] >= 1.0 && size[0] <= 1e5 && size[1] >= 1.0 && size[1] <= 1e5)) {
      entry.At("resolution")
          .Fail("bad resolution", "width and height must be 1 to 100000 px",
                "write resolution: [640, 480]");
    }
    const Value* topic = entry.Find("rostopic");
    Camera camera{model,
                  {static_cast<int>(size[0]), static_cast<int>(size[1])},
                  topic != nullptr ? topic->AsString() : "/" + name + "/image_raw",
                  std::nullopt};
    if (const Value* T_cn_cnm1 = entry.Find("T_cn_cnm1")) {
      camera.T_cn_cnm1 = Rigid3FromValue(*T_cn_cnm1);
    }
    cameras.push_back(std::move(camera));
  }
  if (cameras.empty()) {
    value.Fail("no camera", "the file has no cam0", "give at least one camera, under the key cam0");
  }
  return cameras;
}

Value ToValue(const std::vector<Camera>& cameras) {
  Value chain = Value::Object();
  for (size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i];
    const std::string name(camera.model.name());
    const size_t dash = name.find('-');
    const std::string distortion = name.substr(dash + 1);
    Value entry = Value::Object();
    entry.Set("camera_model", name.substr(0, dash))
        .Set("intrinsics", Value::Numbers(camera.model.intrinsics()))
        .Set("distortion_model", distortion == "equi" ? "equidistant" : distortion)
        .Set("distortion_coeffs", Value::Numbers(camera.model.distortion()));
    Value resolution = Value::Array();
    resolution.Append(camera.resolution.width).Append(camera.resolution.height);
    entry.Set("resolution", std::move(resolution)).Set("rostopic", camera.rostopic);
    if (camera.T_cn_cnm1) entry.Set("T_cn_cnm1", ToValue(*camera.T_cn_cnm1));
    chain.Set("cam" + std::to_string(i), std::move(entry));
  }
  return chain;
}

}  // namespace calibrato
