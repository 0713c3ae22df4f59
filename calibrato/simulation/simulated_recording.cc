#include "calibrato/simulation/simulated_recording.h"

#include <Eigen/Geometry>
#include <cmath>

#include "calibrato/base/value.h"
#include "calibrato/recording/corner_list.h"
#include "calibrato/recording/imu_list.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

constexpr double kTruthRateHz = 200.0;

std::string SensorYaml(const Rig& rig) {
  const Camera& camera = rig.cameras.front();
  Value resolution = Value::Array();
  resolution.Append(camera.resolution.width).Append(camera.resolution.height);
  Value sensor = Value::Object();
  sensor.Set("resolution", std::move(resolution)).Set("rate_hz", rig.camera_rate_hz);
  return ToYaml(sensor);
}

std::string TruthYaml(const Rig& rig, const SimulatedImu& imu) {
  Value truth = ToValue(rig.cameras);
  Value camera = truth.At("cam0");
  camera.Set("T_cam_imu", ToValue(rig.T_c0_i))
      .Set("timeshift_cam_imu", rig.time_offset_i_c.seconds());
  truth.Set("cam0", std::move(camera));
  Value biases = Value::Object();
  biases.Set("gyro_bias", Value::Numbers(imu.mean_gyro_bias))
      .Set("accel_bias", Value::Numbers(imu.mean_accel_bias));
  Value imus = Value::Object();
  imus.Set("imu0", std::move(biases));
  truth.Set("biases", std::move(imus));
  const Eigen::Vector3d gravity_g =
      rig.T_w_g.R.transpose() * Eigen::Vector3d(0.0, 0.0, -kStandardGravity);
  truth.Set("gravity_g", Value::Numbers(gravity_g));
  return ToYaml(truth);
}

std::string TruthPoses(const Rig& rig, const CarrierPath& path, Time start) {
  std::string text = "timestamp [ns],x,y,z,qw,qx,qy,qz\n";
  const Time start_imu = start + rig.time_offset_i_c;
  // In the time that the IMU's clock shows.
  const double ticks_per_s = 1.0 + 1e-6 * rig.imu_disturbances.clock_drift_ppm;
  const auto num_poses =
      static_cast<int>(std::floor(path.duration_s * ticks_per_s * kTruthRateHz)) + 1;
  const Duration period = Duration::FromSeconds(1.0 / kTruthRateHz);
  for (int k = 0; k < num_poses; ++k) {
    const Duration elapsed = period * k;
    const Rigid3 T_g_i =
        BoardInCamera(rig, path.at(elapsed.seconds() / ticks_per_s).T_b_e).Inverse() * rig.T_c0_i;
    const Eigen::Quaterniond q(T_g_i.R);
    text += std::to_string((start_imu + elapsed).nanoseconds());
    for (const double x : {T_g_i.t.x(), T_g_i.t.y(), T_g_i.t.z(), q.w(), q.x(), q.y(), q.z()}) {
      text += "," + FormatNumber(x);
    }
    text += "\n";
  }
  return text;
}

}  // namespace

std::map<std::string, std::string> SimulatedRecordingFiles(const Rig& rig,
                                                           const TimedMotion& motion, Time start,
                                                           const SimulatedRun& run) {
  std::map<std::string, std::string> files = {
      {"imu0.csv", ImuListText(run.imu.stream)},
      {"imu.yaml", ToYaml(ToValue(rig.imu_noise))},
      {"sensor.yaml", SensorYaml(rig)},
      {"target.yaml", ToYaml(ToValue(rig.board))},
      {"rig.yaml", ToYaml(ToValue(rig))},
      {"motion.yaml", ToYaml(ToValue(motion))},
      {"truth.yaml", TruthYaml(rig, run.imu)},
      {"truth_poses.csv", TruthPoses(rig, run.path, start)}};
  if (run.images.empty()) {
    files["cam0_corners.csv"] = CornerListText(run.frames.views, PointsPerTag(rig.board));
  }
  for (const StampedPng& image : run.images) {
    files["cam0/data/" + std::to_string(image.stamp.nanoseconds()) + ".png"] = image.png;
  }
  return files;
}

}  // namespace calibrato
