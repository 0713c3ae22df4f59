#include "calibrato/sensors/imu_file.h"

#include <Eigen/LU>
#include <array>
#include <optional>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/camera_chain.h"

namespace calibrato {
namespace {

// In the order of the enum.
const std::vector<std::string> kModelNames = {"calibrated", "scale-misalignment",
                                              "scale-misalignment-size-effect"};
constexpr std::array<const char*, 3> kLeverArmKeys = {"rx_i", "ry_i", "rz_i"};

void AppendUnknownKeys(const Value& value, const std::vector<std::string>& known,
                       std::vector<std::string>* warnings) {
  if (warnings == nullptr) return;
  const std::vector<std::string> unknown = value.UnknownKeys(known);
  warnings->insert(warnings->end(), unknown.begin(), unknown.end());
}

Eigen::Matrix3d MatrixFromValue(const Value& value) {
  const std::vector<double> numbers = value.AsDoubles(9);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
}

Eigen::Matrix3d LowerTriangleFromValue(const Value& value) {
  const Eigen::Matrix3d M = MatrixFromValue(value);
  constexpr double kTolerance = 1e-9;
  const bool is_lower = Eigen::Vector3d(M(0, 1), M(0, 2), M(1, 2)).norm() <= kTolerance;
  if (!is_lower || !(M.diagonal().minCoeff() > 0.0)) {
    value.Fail("bad matrix M", "it must be a lower triangle with a positive diagonal",
               "write [[sx, 0, 0], [a, sy, 0], [b, c, sz]]; a rotation belongs into C_gyro_i");
  }
  return M;
}

Eigen::Matrix3d RotationFromValue(const Value& value) {
  const Eigen::Matrix3d R = MatrixFromValue(value);
  constexpr double kTolerance = 1e-3;
  const double error = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kTolerance) || !(R.determinant() > 0.0)) {
    value.Fail("bad rotation", "its rows are not of length 1 and at right angles to each other",
               "give a rotation matrix row by row");
  }
  // A rotation to all its digits is kept as it is, so that files read back to the same bytes.
  constexpr double kExact = 1e-14;
  return error < kExact ? R : NearestRotation(R);
}

Value ToValue(const Eigen::Matrix3d& matrix) {
  Value rows = Value::Array();
  for (int row = 0; row < 3; ++row) {
    rows.Append(Value::Numbers(Eigen::Vector3d(matrix.row(row))));
  }
  return rows;
}

Imu ImuFromEntry(const Value& entry, const std::string& name, std::vector<std::string>* warnings) {
  AppendUnknownKeys(
      entry,
      {"rostopic", "update_rate", "accelerometer_noise_density", "accelerometer_random_walk",
       "gyroscope_noise_density", "gyroscope_random_walk", "model", "T_i_b", "time_offset",
       "accelerometers", "gyroscopes"},
      warnings);
  Imu imu;
  imu.noise = ImuNoiseFromValue(entry);
  imu.intrinsics = ImuIntrinsicsFromValue(entry, warnings);
  const Value* topic = entry.Find("rostopic");
  imu.rostopic = topic != nullptr ? topic->AsString() : "/" + name;
  if (const Value* model = entry.Find("model")) {
    try {
      imu.model = ImuModelFromName(model->AsString());
    } catch (const InputError& error) {
      model->Fail("unknown IMU model", error.what(), "correct it or leave the key out");
    }
  }
  if (const Value* T_i_b = entry.Find("T_i_b")) imu.T_i_b = Rigid3FromValue(*T_i_b);
  if (const Value* offset = entry.Find("time_offset")) {
    const double seconds = offset->AsDouble();
    constexpr double kMaxOffset = 1e6;
    if (!(seconds >= -kMaxOffset && seconds <= kMaxOffset)) {
      offset->Fail("bad time offset", "it must lie within 1e6 s", "write it in seconds");
    }
    imu.time_offset = Duration::FromSeconds(seconds);
  }
  return imu;
}

}  // namespace

std::string ImuModelName(ImuModelKind model) { return kModelNames[static_cast<size_t>(model)]; }

ImuModelKind ImuModelFromName(const std::string& name) {
  for (size_t i = 0; i < kModelNames.size(); ++i) {
    if (kModelNames[i] == name) return static_cast<ImuModelKind>(i);
  }
  const std::optional<std::string> nearest = NearestName(name, kModelNames);
  throw InputError(
      {"unknown IMU model '" + name + "'", "",
       "there are " + kModelNames[0] + ", " + kModelNames[1] + " and " + kModelNames[2],
       nearest ? "did you mean " + *nearest + "?" : "choose one of them"});
}

ImuNoise ImuNoiseFromValue(const Value& value) {
  ImuNoise noise;
  noise.rate_hz = value.At("update_rate").AsPositive();
  noise.accel_noise_density = value.At("accelerometer_noise_density").AsPositive();
  noise.accel_random_walk = value.At("accelerometer_random_walk").AsPositive();
  noise.gyro_noise_density = value.At("gyroscope_noise_density").AsPositive();
  noise.gyro_random_walk = value.At("gyroscope_random_walk").AsPositive();
  return noise;
}

Value ToValue(const ImuNoise& noise, const std::string& rostopic) {
  Value value = Value::Object();
  value.Set("rostopic", rostopic)
      .Set("update_rate", noise.rate_hz)
      .Set("accelerometer_noise_density", noise.accel_noise_density)
      .Set("accelerometer_random_walk", noise.accel_random_walk)
      .Set("gyroscope_noise_density", noise.gyro_noise_density)
      .Set("gyroscope_random_walk", noise.gyro_random_walk);
  return value;
}

ImuIntrinsics ImuIntrinsicsFromValue(const Value& entry, std::vector<std::string>* warnings) {
  ImuIntrinsics intrinsics;
  if (const Value* accel = entry.Find("accelerometers")) {
    AppendUnknownKeys(*accel, {"M", "rx_i", "ry_i", "rz_i"}, warnings);
    if (const Value* M = accel->Find("M")) intrinsics.M_accel = LowerTriangleFromValue(*M);
    for (int k = 0; k < 3; ++k) {
      const Value* arm = accel->Find(kLeverArmKeys[k]);
      if (arm == nullptr) continue;
      intrinsics.lever_arms_i.col(k) = Eigen::Vector3d(arm->AsDoubles(3).data());
    }
    if (!intrinsics.lever_arms_i.col(0).isZero(0.0)) {
      accel->At("rx_i").Fail("bad lever arm", "the IMU's origin is where its x axis is sensed",
                             "write rx_i: [0.0, 0.0, 0.0] and take it from ry_i and rz_i");
    }
  }
  if (const Value* gyro = entry.Find("gyroscopes")) {
    AppendUnknownKeys(*gyro, {"M", "A", "C_gyro_i"}, warnings);
    if (const Value* M = gyro->Find("M")) intrinsics.M_gyro = LowerTriangleFromValue(*M);
    if (const Value* A = gyro->Find("A")) intrinsics.g_sensitivity = MatrixFromValue(*A);
    if (const Value* C = gyro->Find("C_gyro_i")) intrinsics.R_gyro_i = RotationFromValue(*C);
  }
  return intrinsics;
}

void SetImuIntrinsics(const ImuIntrinsics& intrinsics, ImuModelKind model, Value* entry) {
  if (model == ImuModelKind::kCalibrated) return;
  Value accel = Value::Object();
  accel.Set("M", ToValue(intrinsics.M_accel));
  if (model == ImuModelKind::kScaleMisalignmentSizeEffect) {
    for (int k = 0; k < 3; ++k) {
      accel.Set(kLeverArmKeys[k], Value::Numbers(Eigen::Vector3d(intrinsics.lever_arms_i.col(k))));
    }
  }
  Value gyro = Value::Object();
  gyro.Set("M", ToValue(intrinsics.M_gyro))
      .Set("A", ToValue(intrinsics.g_sensitivity))
      .Set("C_gyro_i", ToValue(intrinsics.R_gyro_i));
  entry->Set("accelerometers", std::move(accel)).Set("gyroscopes", std::move(gyro));
}

std::vector<Imu> ImusFromValue(const Value& value, std::vector<std::string>* warnings) {
  if (value.Find("imu0") == nullptr && value.Find("update_rate") != nullptr) {
    return {ImuFromEntry(value, "imu0", warnings)};
  }
  std::vector<Imu> imus;
  for (const auto& [name, entry] : value.members()) {
    const std::string expected = "imu" + std::to_string(imus.size());
    if (name != expected) {
      entry.Fail("unexpected key " + name,
                 "IMUs are named imu0, imu1, .. in order, and " + expected + " comes next",
                 "rename it, or give the noise of one IMU alone, from update_rate on");
    }
    imus.push_back(ImuFromEntry(entry, name, warnings));
  }
  if (imus.empty()) {
    value.Fail("no IMU", "the file has neither update_rate nor imu0",
               "give the noise of one IMU, as in docs/formats.md");
  }
  return imus;
}

Value ToValue(const std::vector<Imu>& imus) {
  Value value = Value::Object();
  for (size_t i = 0; i < imus.size(); ++i) {
    const Imu& imu = imus[i];
    Value entry = ToValue(imu.noise, imu.rostopic);
    entry.Set("model", ImuModelName(imu.model))
        .Set("T_i_b", ToValue(imu.T_i_b))
        .Set("time_offset", imu.time_offset.seconds());
    SetImuIntrinsics(imu.intrinsics, imu.model, &entry);
    value.Set("imu" + std::to_string(i), std::move(entry));
  }
  return value;
}

}  // namespace calibrato
