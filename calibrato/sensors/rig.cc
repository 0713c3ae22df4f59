#include "calibrato/sensors/rig.h"

#include <cmath>

#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

// Below it two images are further apart than any motion is long, and in the end than stamps reach.
constexpr double kMinCameraRateHz = 0.01;
constexpr double kMaxCameraRateHz = 1000.0;
constexpr double kMaxStandMotion = 0.1;  // [m]
constexpr double kMaxFingerReach = 1.0;  // [m]

CornerNoise CornerNoiseFromValue(const Value& value, std::vector<std::string>* warnings) {
  const std::vector<std::string> unknown =
      value.UnknownKeys({"stddev_px", "blur_factor", "blur_knee_px", "blur_at_half", "blur_slope",
                         "lost_at_half_px", "lost_slope_px", "phase_error_px"});
  if (warnings != nullptr) warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  CornerNoise noise;
  if (const Value* x = value.Find("stddev_px")) noise.stddev_px = x->AsNonNegative();
  if (const Value* x = value.Find("blur_factor")) noise.blur_factor = x->AsNonNegative();
  if (const Value* x = value.Find("blur_knee_px")) noise.blur_knee_px = x->AsPositive();
  if (const Value* x = value.Find("blur_at_half")) noise.blur_at_half = x->AsPositive();
  if (const Value* x = value.Find("blur_slope")) noise.blur_slope = x->AsPositive();
  if (const Value* x = value.Find("lost_at_half_px")) noise.lost_at_half_px = x->AsPositive();
  if (const Value* x = value.Find("lost_slope_px")) noise.lost_slope_px = x->AsPositive();
  if (const Value* x = value.Find("phase_error_px")) noise.phase_error_px = x->AsNonNegative();
  return noise;
}

}  // namespace

double CornerNoise::Stddev(double blur_px) const {
  return std::hypot(stddev_px,
                    blur_factor * blur_px * std::sqrt(1.0 + std::pow(blur_px / blur_knee_px, 6)));
}

double CornerNoise::DetectionProbability(double blur_px, double spacing_px) const {
  const double smeared = std::exp((blur_px / spacing_px - blur_at_half) / blur_slope);
  const double too_long = std::exp((blur_px - lost_at_half_px) / lost_slope_px);
  return 1.0 / (1.0 + smeared) / (1.0 + too_long);
}

Rig RigFromValue(const Value& value, std::vector<std::string>* warnings) {
  if (warnings != nullptr) {
    const std::vector<std::string> unknown =
        value.UnknownKeys({"cameras", "imu", "board", "T_e_c0", "exposure_s", "rate_hz", "noise",
                           "images", "arm", "lens_residual", "stand_motion_m"});
    warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  }
  Rig rig;
  rig.cameras = CameraChainFromValue(value.At("cameras"), warnings);
  rig.T_e_c0 = Rigid3FromValue(value.At("T_e_c0"));
  const Value& imu = value.At("imu");
  if (warnings != nullptr) {
    const std::vector<std::string> unknown = imu.UnknownKeys(
        {"rostopic", "update_rate", "accelerometer_noise_density", "accelerometer_random_walk",
         "gyroscope_noise_density", "gyroscope_random_walk", "accelerometers", "gyroscopes",
         "T_cam_imu", "time_offset_s", "disturbances"});
    warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  }
  rig.imu_noise = ImuNoiseFromValue(imu);
  rig.imu_disturbances = ImuDisturbancesFromValue(imu, warnings);
  rig.T_c0_i = Rigid3FromValue(imu.At("T_cam_imu"));
  if (const Value* offset = imu.Find("time_offset_s")) {
    const double seconds = offset->AsDouble();
    if (!(seconds >= -1e6 && seconds <= 1e6)) {
      offset->Fail("bad time offset", "it must lie within 1e6 s", "write it in seconds");
    }
    rig.time_offset_i_c = Duration::FromSeconds(seconds);
  }
  rig.board = BoardFromValue(value.At("board"), warnings);
  rig.T_w_g = Rigid3FromValue(value.At("board").At("T_w_g"));
  if (const Value* stand = value.Find("stand_motion_m")) {
    rig.stand_motion_m = stand->AsNonNegative();
    if (!(rig.stand_motion_m <= kMaxStandMotion)) {
      stand->Fail("bad stand of the board", "it moves by more than 0.1 m", "write metres");
    }
  }
  if (const Value* residual = value.Find("lens_residual")) {
    rig.lens_residual = LensResidualFromValue(*residual, warnings);
  }
  if (const Value* exposure = value.Find("exposure_s")) rig.exposure_s = exposure->AsNonNegative();
  if (const Value* rate = value.Find("rate_hz")) {
    rig.camera_rate_hz = rate->AsPositive();
    if (!(rig.camera_rate_hz <= kMaxCameraRateHz)) {
      rate->Fail("bad rate of the camera", "it is more than 1000 Hz", "write images a second");
    }
    if (!(rig.camera_rate_hz >= kMinCameraRateHz)) {
      rate->Fail("bad rate of the camera", "it is less than 0.01 Hz", "write images a second");
    }
  }
  if (const Value* noise = value.Find("noise")) {
    rig.corner_noise = CornerNoiseFromValue(*noise, warnings);
  }
  if (const Value* images = value.Find("images")) {
    rig.image_disturbances = ImageDisturbancesFromValue(*images, warnings);
  }
  if (!(rig.image_disturbances.line_delay_s * rig.cameras.front().resolution.height <=
        1.0 / rig.camera_rate_hz)) {
    value.At("images")
        .At("line_delay_s")
        .Fail("too slow a rolling shutter", "an image is not read before the next one begins",
              "write the seconds from one row to the next, or a lower rate_hz");
  }
  if (const Value* arm = value.Find("arm")) {
    if (warnings != nullptr) {
      const std::vector<std::string> unknown =
          arm->UnknownKeys({"limits", "disturbances", "finger_reach_m"});
      warnings->insert(warnings->end(), unknown.begin(), unknown.end());
    }
    if (const Value* limits = arm->Find("limits")) {
      rig.arm_limits = ArmLimitsFromValue(*limits, warnings);
    }
    if (const Value* reach = arm->Find("finger_reach_m")) {
      rig.finger_reach_m = reach->AsNonNegative();
      if (!(rig.finger_reach_m <= kMaxFingerReach)) {
        reach->Fail("bad reach of a finger", "it is more than 1 m", "write metres");
      }
    }
    if (const Value* disturbances = arm->Find("disturbances")) {
      rig.arm_disturbances = ArmDisturbancesFromValue(*disturbances, warnings);
    }
  }
  return rig;
}

Value ToValue(const Rig& rig) {
  Value imu = ToValue(rig.imu_noise);
  imu.Set("T_cam_imu", ToValue(rig.T_c0_i)).Set("time_offset_s", rig.time_offset_i_c.seconds());
  SetImuDisturbances(rig.imu_disturbances, &imu);
  Value board = ToValue(rig.board);
  board.Set("T_w_g", ToValue(rig.T_w_g));
  Value noise = Value::Object();
  noise.Set("stddev_px", rig.corner_noise.stddev_px)
      .Set("blur_factor", rig.corner_noise.blur_factor)
      .Set("blur_knee_px", rig.corner_noise.blur_knee_px)
      .Set("blur_at_half", rig.corner_noise.blur_at_half)
      .Set("blur_slope", rig.corner_noise.blur_slope)
      .Set("lost_at_half_px", rig.corner_noise.lost_at_half_px)
      .Set("lost_slope_px", rig.corner_noise.lost_slope_px)
      .Set("phase_error_px", rig.corner_noise.phase_error_px);
  Value arm = Value::Object();
  arm.Set("limits", ToValue(rig.arm_limits))
      .Set("disturbances", ToValue(rig.arm_disturbances))
      .Set("finger_reach_m", rig.finger_reach_m);
  Value value = Value::Object();
  value.Set("cameras", ToValue(rig.cameras))
      .Set("imu", std::move(imu))
      .Set("board", std::move(board))
      .Set("stand_motion_m", rig.stand_motion_m)
      .Set("T_e_c0", ToValue(rig.T_e_c0))
      .Set("lens_residual", ToValue(rig.lens_residual))
      .Set("exposure_s", rig.exposure_s)
      .Set("rate_hz", rig.camera_rate_hz)
      .Set("noise", std::move(noise))
      .Set("images", ToValue(rig.image_disturbances))
      .Set("arm", std::move(arm));
  return value;
}

}  // namespace calibrato
