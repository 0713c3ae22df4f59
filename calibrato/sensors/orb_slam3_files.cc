// ORB-SLAM3: one settings file, version 1.0.

#include <cmath>

#include "calibrato/base/input_error.h"
#include "calibrato/sensors/foreign_calibration.h"
#include "calibrato/sensors/opencv_yaml.h"

namespace calibrato {
namespace {

constexpr const char* kProgram = "ORB-SLAM3";

std::string TypeOf(const Camera& camera) {
  const std::string name(camera.model.name());
  if (name == "pinhole-none" || name == "pinhole-radtan" || name == "pinhole-radtan5") {
    return "PinHole";
  }
  if (name == "pinhole-equi") return "KannalaBrandt8";
  RefuseLens(camera, kProgram, "pinhole-none, pinhole-radtan, pinhole-radtan5 and pinhole-equi");
}

void SetCamera(const Camera& camera, const std::string& name, OpenCvYaml* yaml) {
  const Eigen::Vector4d projection = camera.model.focal_and_centre();
  const Eigen::VectorXd distortion = camera.model.distortion();
  const std::array<const char*, 4> keys = {".fx", ".fy", ".cx", ".cy"};
  for (int k = 0; k < 4; ++k) yaml->Real(name + keys[k], projection(k));
  const bool is_fisheye = camera.model.name() == "pinhole-equi";
  const std::array<const char*, 5> names =
      is_fisheye ? std::array<const char*, 5>{".k1", ".k2", ".k3", ".k4", ""}
                 : std::array<const char*, 5>{".k1", ".k2", ".p1", ".p2", ".k3"};
  for (Eigen::Index k = 0; k < distortion.size(); ++k) yaml->Real(name + names[k], distortion(k));
  if (is_fisheye) {
    yaml->Whole(name + ".overlappingBegin", 0)
        .Whole(name + ".overlappingEnd", camera.resolution.width - 1);
  }
}

}  // namespace

ForeignFiles OrbSlam3Files(const RigCalibration& rig, std::optional<double> camera_rate_hz) {
  RequirePlainImu(rig, kProgram);
  if (!camera_rate_hz) {
    throw InputError({std::string(kProgram) + " asks for the camera's rate", "",
                      "a calibration does not have it", "give --camera-rate, in images a second"});
  }
  const size_t num_cameras = rig.cameras.size();
  if (num_cameras > 2) {
    throw InputError({std::string(kProgram) + " takes one or two cameras", "",
                      "this result has " + std::to_string(num_cameras),
                      "calibrate the two that it is to use"});
  }
  ForeignFiles files;
  WarnOfWhatIsLeftOut(rig, kProgram, false, &files.warnings);
  OpenCvYaml yaml;
  yaml.Text("File.version", "1.0").Text("Camera.type", TypeOf(rig.cameras[0]));
  SetCamera(rig.cameras[0], "Camera1", &yaml);
  if (num_cameras == 2) {
    if (TypeOf(rig.cameras[1]) != TypeOf(rig.cameras[0])) {
      throw InputError({std::string(kProgram) + " wants both lenses of one type", "",
                        "cam0 is " + std::string(rig.cameras[0].model.name()) + ", cam1 is " +
                            std::string(rig.cameras[1].model.name()),
                        "calibrate both with one --model"});
    }
    const auto T_c0_c1 = rig.PosesInFirst()[1];
    if (!T_c0_c1) {
      throw InputError({"the cameras are not related to each other", "",
                        "the calibration does not say where cam1 is from cam0",
                        "record views that both share"});
    }
    SetCamera(rig.cameras[1], "Camera2", &yaml);
    yaml.Comment("Camera 2 to camera 1").Matrix("Stereo.T_c1_c2", T_c0_c1->Matrix(), true);
    yaml.Real("Stereo.ThDepth", 60.0);
    if (TypeOf(rig.cameras[0]) == "KannalaBrandt8") {
      files.warnings.emplace_back(
          "ORB-SLAM3 1.0 takes the second fisheye's k1 to k4 from the first (Settings.cc): mend it "
          "there");
    }
  }
  yaml.Whole("Camera.width", rig.cameras[0].resolution.width)
      .Whole("Camera.height", rig.cameras[0].resolution.height)
      .Whole("Camera.fps", std::lround(*camera_rate_hz))
      .Comment("1: colour images come as RGB, 0: as BGR; grey ones don't care")
      .Whole("Camera.RGB", 1);
  if (rig.imu) {
    const ImuNoise& noise = rig.imu->noise;
    yaml.Comment("Camera 1 to IMU")
        .Matrix("IMU.T_b_c1", rig.on_imu[0].T_c_i.Inverse().Matrix(), true)
        .Comment("Continuous-time densities")
        .Real("IMU.NoiseGyro", noise.gyro_noise_density)
        .Real("IMU.NoiseAcc", noise.accel_noise_density)
        .Real("IMU.GyroWalk", noise.gyro_random_walk)
        .Real("IMU.AccWalk", noise.accel_random_walk)
        .Real("IMU.Frequency", noise.rate_hz);
    for (size_t n = 0; n < num_cameras; ++n) {
      const double offset = rig.on_imu[n].time_offset_s;
      if (offset == 0.0) continue;
      const std::string remedy =
          "add " + FormatNumber(offset) + " s to the stamps of cam" + std::to_string(n);
      yaml.Comment("The images' stamps must be on the IMU's clock: " + remedy);
      files.warnings.push_back(std::string(kProgram) +
                               " has no place for a time offset: " + remedy);
    }
  }
  yaml.Comment("Features and viewer, as in ORB-SLAM3's own examples: no part of the calibration")
      .Whole("ORBextractor.nFeatures", 1200)
      .Real("ORBextractor.scaleFactor", 1.2)
      .Whole("ORBextractor.nLevels", 8)
      .Whole("ORBextractor.iniThFAST", 20)
      .Whole("ORBextractor.minThFAST", 7)
      .Real("Viewer.KeyFrameSize", 0.05)
      .Real("Viewer.KeyFrameLineWidth", 1.0)
      .Real("Viewer.GraphLineWidth", 0.9)
      .Real("Viewer.PointSize", 2.0)
      .Real("Viewer.CameraSize", 0.08)
      .Real("Viewer.CameraLineWidth", 3.0)
      .Real("Viewer.ViewpointX", 0.0)
      .Real("Viewer.ViewpointY", -0.7)
      .Real("Viewer.ViewpointZ", -3.5)
      .Real("Viewer.ViewpointF", 500.0);
  files.content["orb_slam3.yaml"] = yaml.text();
  return files;
}

}  // namespace calibrato
