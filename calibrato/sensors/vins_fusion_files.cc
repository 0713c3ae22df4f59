// VINS-Fusion: an OpenCV YAML of the rig, and one of camodocal's a camera.

#include <cmath>

#include "calibrato/base/input_error.h"
#include "calibrato/sensors/foreign_calibration.h"
#include "calibrato/sensors/opencv_yaml.h"

namespace calibrato {
namespace {

constexpr const char* kProgram = "VINS-Fusion";

void SetProjection(const Eigen::Vector4d& fu_fv_pu_pv, const std::array<const char*, 4>& keys,
                   OpenCvYaml* yaml) {
  for (int k = 0; k < 4; ++k) yaml->Real(std::string("   ") + keys[k], fu_fv_pu_pv(k));
}

void SetRadtan(const double* k1_k2_p1_p2, OpenCvYaml* yaml) {
  yaml->Begin("distortion_parameters");
  const std::array<const char*, 4> keys = {"k1", "k2", "p1", "p2"};
  for (int k = 0; k < 4; ++k) yaml->Real(std::string("   ") + keys[k], k1_k2_p1_p2[k]);
}

std::string CameraYaml(const Camera& camera, const std::string& name) {
  OpenCvYaml yaml;
  const auto begin = [&](const char* type) {
    yaml.Text("model_type", type)
        .Text("camera_name", name)
        .Whole("image_width", camera.resolution.width)
        .Whole("image_height", camera.resolution.height);
  };
  const std::string model(camera.model.name());
  const Eigen::Vector4d projection = camera.model.focal_and_centre();
  if (const auto pinhole = AsPinholeRadtan(camera.model)) {
    begin("PINHOLE");
    SetRadtan(pinhole->data() + 4, &yaml);
    yaml.Begin("projection_parameters");
    SetProjection(projection, {"fx", "fy", "cx", "cy"}, &yaml);
  } else if (model == "pinhole-equi") {
    begin("KANNALA_BRANDT");
    yaml.Begin("projection_parameters");
    // Its k1 is the factor of theta itself, 1, and is not written: ours begin at theta cubed.
    const Eigen::Vector4d k = camera.model.distortion();
    for (int i = 0; i < 4; ++i) yaml.Real("   k" + std::to_string(i + 2), k(i));
    SetProjection(projection, {"mu", "mv", "u0", "v0"}, &yaml);
  } else if (model == "omni-radtan" || model == "omni-none") {
    begin("MEI");
    yaml.Begin("mirror_parameters").Real("   xi", camera.model.intrinsics()(0));
    Eigen::Vector4d distortion = Eigen::Vector4d::Zero();
    if (model == "omni-radtan") distortion = camera.model.distortion();
    SetRadtan(distortion.data(), &yaml);
    yaml.Begin("projection_parameters");
    SetProjection(projection, {"gamma1", "gamma2", "u0", "v0"}, &yaml);
  } else {
    RefuseLens(camera, kProgram,
               "pinhole-none, pinhole-radtan, pinhole-equi, omni-none and omni-radtan");
  }
  return yaml.text();
}

}  // namespace

ForeignFiles VinsFusionFiles(const RigCalibration& rig) {
  RequirePlainImu(rig, kProgram);
  ForeignFiles files;
  const size_t num_cameras = rig.cameras.size();
  if (num_cameras > 2 || (num_cameras == 1 && !rig.imu)) {
    throw InputError(
        {std::string(kProgram) + " takes one or two cameras with an IMU, or two alone", "",
         "this result has " + std::to_string(num_cameras) + (rig.imu ? " with one" : " and no IMU"),
         "calibrate such a rig"});
  }
  WarnOfWhatIsLeftOut(rig, kProgram, true, &files.warnings);
  OpenCvYaml yaml;
  yaml.Whole("imu", rig.imu ? 1 : 0).Whole("num_of_cam", static_cast<int64_t>(num_cameras));
  yaml.Text("imu_topic", rig.imu ? rig.imu->rostopic : "/imu0");
  for (size_t n = 0; n < num_cameras; ++n) {
    yaml.Text("image" + std::to_string(n) + "_topic", rig.cameras[n].rostopic);
  }
  yaml.Text("output_path", "./");
  for (size_t n = 0; n < num_cameras; ++n) {
    const std::string name = "cam" + std::to_string(n);
    yaml.Text(name + "_calib", name + ".yaml");
    files.content[name + ".yaml"] = CameraYaml(rig.cameras[n], name);
  }
  yaml.Whole("image_width", rig.cameras[0].resolution.width)
      .Whole("image_height", rig.cameras[0].resolution.height)
      .Comment("0: the poses below are kept")
      .Whole("estimate_extrinsic", 0);
  const auto in_first = rig.PosesInFirst();
  for (size_t n = 0; n < num_cameras; ++n) {
    if (!in_first[n]) {
      throw InputError({"the cameras are not related to each other", "",
                        "the calibration does not say where cam1 is from cam0",
                        "record views that both share"});
    }
    // Without an IMU the body is the first camera.
    const Rigid3 T_body_c = rig.imu ? rig.on_imu[n].T_c_i.Inverse() : *in_first[n];
    yaml.Matrix("body_T_cam" + std::to_string(n), T_body_c.Matrix());
  }
  yaml.Whole("multiple_thread", 1)
      .Comment("Tracker and solver, as in VINS-Fusion's own examples: no part of the calibration")
      .Whole("max_cnt", 150)
      .Whole("min_dist", 30)
      .Whole("freq", 10)
      .Real("F_threshold", 1.0)
      .Whole("show_track", 0)
      .Whole("flow_back", 1)
      .Real("max_solver_time", 0.04)
      .Whole("max_num_iterations", 8)
      .Real("keyframe_parallax", 10.0);
  if (rig.imu) {
    const ImuNoise& noise = rig.imu->noise;
    const double root_rate = std::sqrt(noise.rate_hz);
    // A step takes the mean of two samples and draws their noise apart: half of acc_n^2 dt^2, which
    // must be n^2 dt.
    const double root_double_rate = std::sqrt(2.0 * noise.rate_hz);
    yaml.Comment(
            "acc_n, gyr_n: densities times the root of twice the rate; acc_w, gyr_w: random walks "
            "times the root of the rate")
        .Real("acc_n", noise.accel_noise_density * root_double_rate)
        .Real("gyr_n", noise.gyro_noise_density * root_double_rate)
        .Real("acc_w", noise.accel_random_walk * root_rate)
        .Real("gyr_w", noise.gyro_random_walk * root_rate)
        .Real("g_norm", rig.gravity)
        .Whole("estimate_td", 0)
        .Comment("Stamp of the image + td = time of the IMU's clock [s]")
        .Real("td", rig.on_imu[0].time_offset_s);
  }
  yaml.Whole("load_previous_pose_graph", 0)
      .Text("pose_graph_save_path", "./")
      .Whole("save_image", 0);
  files.content["vins_fusion.yaml"] = yaml.text();
  return files;
}

}  // namespace calibrato
