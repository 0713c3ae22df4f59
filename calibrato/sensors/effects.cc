#include "calibrato/sensors/effects.h"

#include <optional>
#include <sstream>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"

namespace calibrato {
namespace {

constexpr double kExposure = 0.005;  // [s]

// Full scale and one step of 16 bits: 500 degrees/s and 8 g, as small IMUs are often set.
constexpr double kGyroRange = 8.7;          // [rad/s]
constexpr double kGyroResolution = 2.7e-4;  // [rad/s]
constexpr double kAccelRange = 78.0;        // [m/s^2]
constexpr double kAccelResolution = 2.4e-3;

void SwitchOnVaryingExposure(Rig* rig) {
  // There is nothing to vary about no exposure.
  if (rig->exposure_s == 0.0) rig->exposure_s = kExposure;
  rig->image_disturbances.exposure_variation = 0.5;
}

void SwitchOnSensorNoise(Rig* rig) {
  rig->image_disturbances.read_noise = 1.5;
  rig->image_disturbances.shot_noise = 0.02;
}

void SwitchOnScale(Rig* rig) {
  ImuIntrinsics& imu = rig->imu_disturbances.intrinsics;
  imu.M_accel.diagonal() = Eigen::Vector3d(1.004, 0.997, 1.005);
  imu.M_accel(1, 0) = 0.002;
  imu.M_gyro.diagonal() = Eigen::Vector3d(0.997, 1.003, 1.002);
  imu.M_gyro(2, 1) = -0.002;
}

void SwitchOnSaturation(Rig* rig) {
  rig->imu_disturbances.gyro_range = kGyroRange;
  rig->imu_disturbances.accel_range = kAccelRange;
}

void SwitchOnQuantisation(Rig* rig) {
  rig->imu_disturbances.gyro_resolution = kGyroResolution;
  rig->imu_disturbances.accel_resolution = kAccelResolution;
}

}  // namespace

const std::vector<Effect>& Effects() {
  static const std::vector<Effect> effects = {
      {"blur", "exposure_s", "5 ms", [](Rig* rig) { rig->exposure_s = kExposure; }},
      {"varying-exposure", "images.exposure_variation", "5 ms -+ 50 %", SwitchOnVaryingExposure},
      {"lighting-gradient", "images.lighting_gradient", "0.2 to the right, -0.1 down",
       [](Rig* rig) {
         rig->image_disturbances.lighting_gradient = {0.2, -0.1};
       }},
      {"vignetting", "images.vignetting", "0.3",
       [](Rig* rig) { rig->image_disturbances.vignetting = 0.3; }},
      {"defocus", "images.defocus_px", "0.5 px",
       [](Rig* rig) { rig->image_disturbances.defocus_px = 0.5; }},
      {"sensor-noise", "images.read_noise, images.shot_noise", "1.5 levels, 0.02",
       SwitchOnSensorNoise},
      {"lens-residual", "lens_residual.rms_px", "0.1 px",
       [](Rig* rig) { rig->lens_residual.rms_px = 0.1; }},
      {"corner-phase", "noise.phase_error_px", "0.05 px",
       [](Rig* rig) { rig->corner_noise.phase_error_px = 0.05; }},
      {"fingers", "arm.finger_reach_m", "0.2 m", [](Rig* rig) { rig->finger_reach_m = 0.2; }},
      {"rolling-shutter", "images.line_delay_s", "30 us a row",
       [](Rig* rig) { rig->image_disturbances.line_delay_s = 3e-5; }, false},
      {"jitter", "images.stamp_jitter_s", "0.5 ms",
       [](Rig* rig) { rig->image_disturbances.stamp_jitter_s = 5e-4; }},
      {"drops", "images.drop_probability", "5 %",
       [](Rig* rig) { rig->image_disturbances.drop_probability = 0.05; }},
      {"stand-motion", "stand_motion_m", "0.2 mm", [](Rig* rig) { rig->stand_motion_m = 2e-4; }},
      {"elastic-gears", "arm.disturbances.mode_hz", "15 Hz",
       [](Rig* rig) { rig->arm_disturbances.mode_hz = 15.0; }},
      {"torque-ripple", "arm.disturbances.torque_ripple_nm_s_rad", "0.5 N m per rad/s",
       [](Rig* rig) { rig->arm_disturbances.torque_ripple = 0.5; }},
      {"cables", "arm.limits.max_wrist_turn_rad", "1.5 rad",
       [](Rig* rig) { rig->arm_limits.max_wrist_turn = 1.5; }},
      {"imu-low-pass", "imu.disturbances.low_pass_hz", "60 Hz",
       [](Rig* rig) { rig->imu_disturbances.low_pass_hz = 60.0; }},
      {"clock-drift", "imu.disturbances.clock_drift_ppm", "50 ppm",
       [](Rig* rig) { rig->imu_disturbances.clock_drift_ppm = 50.0; }},
      {"imu-scale", "imu.accelerometers.M, imu.gyroscopes.M", "0.2 to 0.5 %, skew 2 mrad",
       SwitchOnScale},
      {"g-sensitivity", "imu.gyroscopes.A", "1e-4 rad/s per m/s^2 on each axis",
       [](Rig* rig) {
         rig->imu_disturbances.intrinsics.g_sensitivity = 1e-4 * Eigen::Matrix3d::Identity();
       }},
      {"saturation", "imu.disturbances.gyro_range_rad_s, accel_range_m_s2", "8.7 rad/s, 78 m/s^2",
       SwitchOnSaturation},
      {"quantisation", "imu.disturbances.gyro_resolution_rad_s, accel_resolution_m_s2",
       "2.7e-4 rad/s, 2.4e-3 m/s^2", SwitchOnQuantisation},
  };
  return effects;
}

void SwitchOnEffects(const std::string& names, Rig* rig) {
  std::vector<std::string> known = {"all"};
  for (const Effect& effect : Effects()) known.emplace_back(effect.name);
  std::istringstream list(names);
  for (std::string name; std::getline(list, name, ',');) {
    if (name == "all") {
      for (const Effect& effect : Effects()) {
        if (effect.is_everywhere) effect.switch_on(rig);
      }
      continue;
    }
    const Effect* found = nullptr;
    for (const Effect& effect : Effects()) {
      if (effect.name == name) found = &effect;
    }
    if (found == nullptr) {
      const std::optional<std::string> nearest = NearestName(name, known);
      throw InputError({"unknown effect '" + name + "'", "", "",
                        nearest ? "did you mean " + *nearest + "?"
                                : "use all, or the names in docs/simulation.md"});
    }
    found->switch_on(rig);
  }
}

}  // namespace calibrato
