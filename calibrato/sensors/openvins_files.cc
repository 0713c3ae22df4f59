// OpenVINS: Kalibr's two chains as it reads them, and an estimator configuration that names them.

#include "calibrato/base/input_error.h"
#include "calibrato/sensors/foreign_calibration.h"

namespace calibrato {
namespace {

constexpr const char* kProgram = "OpenVINS";
constexpr const char* kHeader = "%YAML:1.0\n";

Value MatrixValue(const Eigen::Matrix3d& matrix) {
  Value rows = Value::Array();
  for (int row = 0; row < 3; ++row) {
    rows.Append(Value::Numbers(Eigen::Vector3d(matrix.row(row))));
  }
  return rows;
}

Value CameraValue(const Camera& camera, const RigCalibration::CameraOnImu& on_imu) {
  const std::string model(camera.model.name());
  Value value = Value::Object();
  // Where Kalibr writes T_cam_imu, OpenVINS wants its inverse.
  value.Set("T_imu_cam", ToValue(on_imu.T_c_i.Inverse())).Set("camera_model", "pinhole");
  if (const auto pinhole = AsPinholeRadtan(camera.model)) {
    value.Set("distortion_model", "radtan")
        .Set("distortion_coeffs", Value::Numbers(Eigen::Vector4d(pinhole->data() + 4)));
  } else if (model == "pinhole-equi") {
    value.Set("distortion_model", "equidistant")
        .Set("distortion_coeffs", Value::Numbers(camera.model.distortion()));
  } else {
    RefuseLens(camera, kProgram, "pinhole-none, pinhole-radtan and pinhole-equi");
  }
  Value resolution = Value::Array();
  resolution.Append(camera.resolution.width).Append(camera.resolution.height);
  value.Set("intrinsics", Value::Numbers(camera.model.focal_and_centre()))
      .Set("resolution", std::move(resolution))
      .Set("rostopic", camera.rostopic)
      .Set("timeshift_cam_imu", on_imu.time_offset_s);
  return value;
}

Value ImuValue(const Imu& imu) {
  if (imu.model == ImuModelKind::kScaleMisalignmentSizeEffect) {
    throw InputError({std::string(kProgram) + " does not know this IMU model", "",
                      "the IMU was calibrated as " + ImuModelName(imu.model),
                      "calibrate with --imu-model scale-misalignment or calibrated"});
  }
  const ImuIntrinsics& intrinsics = imu.intrinsics;
  Value value = Value::Object();
  value.Set("T_i_b", ToValue(Rigid3{}))
      .Set("accelerometer_noise_density", imu.noise.accel_noise_density)
      .Set("accelerometer_random_walk", imu.noise.accel_random_walk)
      .Set("gyroscope_noise_density", imu.noise.gyro_noise_density)
      .Set("gyroscope_random_walk", imu.noise.gyro_random_walk)
      .Set("rostopic", imu.rostopic)
      .Set("time_offset", 0.0)
      .Set("update_rate", imu.noise.rate_hz)
      .Set("model", "kalibr")
      .Set("Tw", MatrixValue(intrinsics.M_gyro))
      .Set("R_IMUtoGYRO", MatrixValue(intrinsics.R_gyro_i))
      .Set("Ta", MatrixValue(intrinsics.M_accel))
      .Set("R_IMUtoACC", MatrixValue(Eigen::Matrix3d::Identity()))
      // Ours acts on the force in the gyroscope's axes, OpenVINS's on that in the IMU's.
      .Set("Tg", MatrixValue(intrinsics.g_sensitivity * intrinsics.R_gyro_i));
  return value;
}

// What it estimates with, beside the calibration: the settings of its own examples. It refuses a
// configuration in which one of its keys is missing: 2.7 asks for `integration`, versions before it
// for use_imuavg and use_rk4int; what a version does not ask for it passes over.
constexpr const char* kEstimatorSettings = R"(verbosity: "INFO"
use_fej: true
use_imuavg: true
use_rk4int: true
integration: "rk4"
calib_cam_extrinsics: true
calib_cam_intrinsics: true
calib_cam_timeoffset: true
calib_imu_intrinsics: false
calib_imu_g_sensitivity: false
max_clones: 11
max_slam: 50
max_slam_in_update: 25
max_msckf_in_update: 40
dt_slam_delay: 1
feat_rep_msckf: "GLOBAL_3D"
feat_rep_slam: "ANCHORED_MSCKF_INVERSE_DEPTH"
feat_rep_aruco: "ANCHORED_MSCKF_INVERSE_DEPTH"
try_zupt: false
zupt_chi2_multipler: 0
zupt_max_velocity: 0.1
zupt_noise_multiplier: 10
zupt_max_disparity: 0.5
zupt_only_at_beginning: false
init_window_time: 2.0
init_imu_thresh: 1.5
init_max_disparity: 10.0
init_max_features: 75
init_dyn_use: false
init_dyn_mle_opt_calib: false
init_dyn_mle_max_iter: 50
init_dyn_mle_max_time: 0.05
init_dyn_mle_max_threads: 6
init_dyn_num_pose: 6
init_dyn_min_deg: 10.0
init_dyn_inflation_ori: 10
init_dyn_inflation_vel: 100
init_dyn_inflation_bg: 10
init_dyn_inflation_ba: 100
init_dyn_min_rec_cond: 1e-12
init_dyn_bias_g: [0.0, 0.0, 0.0]
init_dyn_bias_a: [0.0, 0.0, 0.0]
record_timing_information: false
record_timing_filepath: "timing.txt"
save_total_state: false
filepath_est: "estimate.txt"
filepath_std: "estimate_std.txt"
filepath_gt: "groundtruth.txt"
use_klt: true
num_pts: 200
fast_threshold: 20
grid_x: 5
grid_y: 5
min_px_dist: 10
knn_ratio: 0.70
track_frequency: 21.0
downsample_cameras: false
num_opencv_threads: 4
histogram_method: "HISTOGRAM"
use_aruco: false
num_aruco: 1024
downsize_aruco: true
up_msckf_sigma_px: 1
up_msckf_chi2_multipler: 1
up_slam_sigma_px: 1
up_slam_chi2_multipler: 1
up_aruco_sigma_px: 1
up_aruco_chi2_multipler: 1
use_mask: false
)";

}  // namespace

ForeignFiles OpenVinsFiles(const RigCalibration& rig) {
  RequireImu(rig, kProgram);
  ForeignFiles files;
  WarnOfWhatIsLeftOut(rig, kProgram, true, &files.warnings);
  Value cameras = Value::Object();
  for (size_t n = 0; n < rig.cameras.size(); ++n) {
    cameras.Set("cam" + std::to_string(n), CameraValue(rig.cameras[n], rig.on_imu[n]));
  }
  Value imus = Value::Object();
  imus.Set("imu0", ImuValue(*rig.imu));
  Value estimator = Value::Object();
  estimator.Set("use_stereo", rig.cameras.size() > 1)
      .Set("max_cameras", rig.cameras.size())
      .Set("gravity_mag", rig.gravity)
      .Set("relative_config_imu", "kalibr_imu_chain.yaml")
      .Set("relative_config_imucam", "kalibr_imucam_chain.yaml");
  files.content["kalibr_imucam_chain.yaml"] = kHeader + ToYaml(cameras);
  files.content["kalibr_imu_chain.yaml"] = kHeader + ToYaml(imus);
  files.content["estimator_config.yaml"] = kHeader + ToYaml(estimator) + kEstimatorSettings;
  return files;
}

}  // namespace calibrato
