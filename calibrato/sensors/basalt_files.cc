// Basalt: calibration.json, as cereal archives its struct Calibration.

#include <Eigen/Geometry>
#include <cmath>

#include "calibrato/sensors/foreign_calibration.h"

namespace calibrato {
namespace {

constexpr const char* kProgram = "Basalt";

Value ThreeTimes(double x) { return Value::Numbers(Eigen::Vector3d::Constant(x).eval()); }

Value CameraValue(const Camera& camera) {
  const std::string name(camera.model.name());
  const Eigen::VectorXd intrinsics = camera.model.intrinsics();
  Eigen::Vector4d projection = camera.model.focal_and_centre();
  std::string type;
  std::vector<std::pair<std::string, double>> others;
  if (name == "pinhole-none") {
    type = "pinhole";
  } else if (name == "pinhole-equi") {
    type = "kb4";
    const Eigen::Vector4d k = camera.model.distortion();
    for (int i = 0; i < 4; ++i) others.emplace_back("k" + std::to_string(i + 1), k(i));
  } else if (name == "ds-none") {
    type = "ds";
    others = {{"xi", intrinsics(0)}, {"alpha", intrinsics(1)}};
  } else if (name == "eucm-none") {
    type = "eucm";
    others = {{"alpha", intrinsics(0)}, {"beta", intrinsics(1)}};
  } else if (name == "omni-none") {
    // x / (z + xi d) = (x / (1 + xi)) / (alpha d + (1 - alpha) z) with alpha = xi / (1 + xi).
    type = "ucm";
    const double xi = intrinsics(0);
    projection.head<2>() /= 1.0 + xi;
    others = {{"alpha", xi / (1.0 + xi)}};
  } else {
    RefuseLens(camera, kProgram, "pinhole-none, pinhole-equi, omni-none, ds-none and eucm-none");
  }
  Value numbers = Value::Object();
  numbers.Set("fx", projection(0))
      .Set("fy", projection(1))
      .Set("cx", projection(2))
      .Set("cy", projection(3));
  for (const auto& [key, number] : others) numbers.Set(key, number);
  return Value::Object().Set("camera_type", type).Set("intrinsics", std::move(numbers));
}

Value PoseValue(const Rigid3& T_i_c) {
  const Eigen::Quaterniond q(T_i_c.R);
  return Value::Object()
      .Set("px", T_i_c.t.x())
      .Set("py", T_i_c.t.y())
      .Set("pz", T_i_c.t.z())
      .Set("qx", q.x())
      .Set("qy", q.y())
      .Set("qz", q.z())
      .Set("qw", q.w());
}

// What it subtracts from a sample, followed by what it multiplies one by, less the identity.
Value BiasValue(const Eigen::Vector3d& bias, int size) {
  Eigen::VectorXd numbers = Eigen::VectorXd::Zero(size);
  numbers.head<3>() = bias;
  return Value::Numbers(numbers);
}

}  // namespace

ForeignFiles BasaltFiles(const RigCalibration& rig) {
  RequireImu(rig, kProgram);
  RequirePlainImu(rig, kProgram);
  ForeignFiles files;
  WarnOfWhatIsLeftOut(rig, kProgram, true, &files.warnings);
  Value poses = Value::Array();
  Value lenses = Value::Array();
  Value resolutions = Value::Array();
  for (size_t n = 0; n < rig.cameras.size(); ++n) {
    poses.Append(PoseValue(rig.on_imu[n].T_c_i.Inverse()));
    lenses.Append(CameraValue(rig.cameras[n]));
    Value size = Value::Array();
    size.Append(rig.cameras[n].resolution.width).Append(rig.cameras[n].resolution.height);
    resolutions.Append(std::move(size));
  }
  const ImuNoise& noise = rig.imu->noise;
  Value calibration = Value::Object();
  calibration.Set("T_imu_cam", std::move(poses))
      .Set("intrinsics", std::move(lenses))
      .Set("resolution", std::move(resolutions))
      .Set("calib_accel_bias", BiasValue(rig.accel_bias, 9))
      .Set("calib_gyro_bias", BiasValue(rig.gyro_bias, 12))
      .Set("imu_update_rate", noise.rate_hz)
      .Set("accel_noise_std", ThreeTimes(noise.accel_noise_density))
      .Set("gyro_noise_std", ThreeTimes(noise.gyro_noise_density))
      .Set("accel_bias_std", ThreeTimes(noise.accel_random_walk))
      .Set("gyro_bias_std", ThreeTimes(noise.gyro_random_walk))
      .Set("cam_time_offset_ns",
           static_cast<int64_t>(std::llround(1e9 * rig.on_imu[0].time_offset_s)))
      .Set("vignette", Value::Array());
  files.content["calibration.json"] = ToJson(Value::Object().Set("value0", std::move(calibration)));
  return files;
}

}  // namespace calibrato
