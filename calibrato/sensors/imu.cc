#include "calibrato/sensors/imu.h"

namespace calibrato {

ImuNoise ImuNoiseFromValue(const Value& value, std::vector<std::string>* warnings) {
  if (warnings != nullptr) {
    const std::vector<std::string> unknown = value.UnknownKeys(
        {"rostopic", "update_rate", "accelerometer_noise_density", "accelerometer_random_walk",
         "gyroscope_noise_density", "gyroscope_random_walk", "T_cam_imu", "time_offset_s"});
    warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  }
  ImuNoise noise;
  noise.rate_hz = value.At("update_rate").AsPositive();
  noise.accel_noise_density = value.At("accelerometer_noise_density").AsPositive();
  noise.accel_random_walk = value.At("accelerometer_random_walk").AsPositive();
  noise.gyro_noise_density = value.At("gyroscope_noise_density").AsPositive();
  noise.gyro_random_walk = value.At("gyroscope_random_walk").AsPositive();
  return noise;
}

Value ToValue(const ImuNoise& noise) {
  Value value = Value::Object();
  value.Set("rostopic", "/imu0")
      .Set("update_rate", noise.rate_hz)
      .Set("accelerometer_noise_density", noise.accel_noise_density)
      .Set("accelerometer_random_walk", noise.accel_random_walk)
      .Set("gyroscope_noise_density", noise.gyro_noise_density)
      .Set("gyroscope_random_walk", noise.gyro_random_walk);
  return value;
}

}  // namespace calibrato
