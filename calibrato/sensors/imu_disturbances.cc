#include "calibrato/sensors/imu_disturbances.h"

#include "calibrato/sensors/imu_file.h"

namespace calibrato {

ImuDisturbances ImuDisturbancesFromValue(const Value& imu, std::vector<std::string>* warnings) {
  ImuDisturbances disturbances;
  disturbances.intrinsics = ImuIntrinsicsFromValue(imu, warnings);
  const Value* value = imu.Find("disturbances");
  if (value == nullptr) return disturbances;
  if (warnings != nullptr) {
    const std::vector<std::string> unknown = value->UnknownKeys(
        {"low_pass_hz", "gyro_bias_rad_s", "accel_bias_m_s2", "gyro_range_rad_s",
         "accel_range_m_s2", "gyro_resolution_rad_s", "accel_resolution_m_s2", "clock_drift_ppm"});
    warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  }
  const auto read_vector = [&](const char* key, Eigen::Vector3d* vector) {
    if (const Value* x = value->Find(key)) *vector = Eigen::Vector3d(x->AsDoubles(3).data());
  };
  const auto read_non_negative = [&](const char* key, double* number) {
    if (const Value* x = value->Find(key)) *number = x->AsNonNegative();
  };
  const auto read_positive = [&](const char* key, double* number) {
    if (const Value* x = value->Find(key)) *number = x->AsPositive();
  };
  read_non_negative("low_pass_hz", &disturbances.low_pass_hz);
  read_vector("gyro_bias_rad_s", &disturbances.gyro_bias);
  read_vector("accel_bias_m_s2", &disturbances.accel_bias);
  read_positive("gyro_range_rad_s", &disturbances.gyro_range);
  read_positive("accel_range_m_s2", &disturbances.accel_range);
  read_non_negative("gyro_resolution_rad_s", &disturbances.gyro_resolution);
  read_non_negative("accel_resolution_m_s2", &disturbances.accel_resolution);
  if (const Value* drift = value->Find("clock_drift_ppm")) {
    disturbances.clock_drift_ppm = drift->AsDouble();
    constexpr double kMaxDrift = 1e4;
    if (!(disturbances.clock_drift_ppm >= -kMaxDrift &&
          disturbances.clock_drift_ppm <= kMaxDrift)) {
      drift->Fail("bad clock drift", "it must lie within 10000 ppm",
                  "write parts per million; clocks of quartz stay below 100");
    }
  }
  return disturbances;
}

void SetImuDisturbances(const ImuDisturbances& disturbances, Value* imu) {
  SetImuIntrinsics(disturbances.intrinsics, ImuModelKind::kScaleMisalignmentSizeEffect, imu);
  Value value = Value::Object();
  value.Set("low_pass_hz", disturbances.low_pass_hz)
      .Set("gyro_bias_rad_s", Value::Numbers(disturbances.gyro_bias))
      .Set("accel_bias_m_s2", Value::Numbers(disturbances.accel_bias))
      .Set("gyro_range_rad_s", disturbances.gyro_range)
      .Set("accel_range_m_s2", disturbances.accel_range)
      .Set("gyro_resolution_rad_s", disturbances.gyro_resolution)
      .Set("accel_resolution_m_s2", disturbances.accel_resolution)
      .Set("clock_drift_ppm", disturbances.clock_drift_ppm);
  imu->Set("disturbances", std::move(value));
}

}  // namespace calibrato
