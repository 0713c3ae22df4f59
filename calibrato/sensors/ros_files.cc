// ROS: sensor_msgs/CameraInfo as camera_info_manager reads it from a YAML file, one a camera.

#include <algorithm>

#include "calibrato/sensors/foreign_calibration.h"

namespace calibrato {
namespace {

Value MatrixValue(int rows, int columns, const std::vector<double>& data) {
  return Value::Object().Set("rows", rows).Set("cols", columns).Set("data", Value::Numbers(data));
}

std::string CameraInfoYaml(const Camera& camera, const std::string& name) {
  const std::string model(camera.model.name());
  std::string distortion_model = "plumb_bob";
  std::vector<double> distortion(5, 0.0);  // k1 k2 p1 p2 k3
  if (model == "pinhole-equi") {
    distortion_model = "equidistant";
    distortion.resize(4);
  } else if (model != "pinhole-none" && model != "pinhole-radtan" && model != "pinhole-radtan5") {
    RefuseLens(camera, "ROS's CameraInfo",
               "pinhole-none, pinhole-radtan, pinhole-radtan5 and pinhole-equi");
  }
  const Eigen::VectorXd coefficients = camera.model.distortion();
  std::copy(coefficients.begin(), coefficients.end(), distortion.begin());
  const Eigen::Vector4d f = camera.model.focal_and_centre();
  Value yaml = Value::Object();
  yaml.Set("image_width", camera.resolution.width)
      .Set("image_height", camera.resolution.height)
      .Set("camera_name", name)
      .Set("camera_matrix", MatrixValue(3, 3, {f(0), 0.0, f(2), 0.0, f(1), f(3), 0.0, 0.0, 1.0}))
      .Set("distortion_model", distortion_model)
      .Set("distortion_coefficients",
           MatrixValue(1, static_cast<int>(distortion.size()), distortion))
      .Set("rectification_matrix", MatrixValue(3, 3, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}))
      .Set("projection_matrix",
           MatrixValue(3, 4, {f(0), 0.0, f(2), 0.0, 0.0, f(1), f(3), 0.0, 0.0, 0.0, 1.0, 0.0}));
  return ToYaml(yaml);
}

}  // namespace

ForeignFiles RosFiles(const RigCalibration& rig) {
  ForeignFiles files;
  for (size_t n = 0; n < rig.cameras.size(); ++n) {
    const std::string name = "cam" + std::to_string(n);
    files.content[name + ".yaml"] = CameraInfoYaml(rig.cameras[n], name);
  }
  if (rig.cameras.size() > 1) {
    files.warnings.emplace_back(
        "each CameraInfo is that of a camera alone: rectify a stereo pair (cv::stereoRectify) with "
        "T_cn_cnm1 of the camera chain, and replace rectification_matrix and projection_matrix");
  }
  if (rig.imu) {
    files.warnings.emplace_back(
        "CameraInfo has no place for the IMU: its pose is in camchain-imucam.yaml");
  }
  return files;
}

}  // namespace calibrato
