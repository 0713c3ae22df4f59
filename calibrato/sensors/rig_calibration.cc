#include "calibrato/sensors/rig_calibration.h"

#include <string>

namespace calibrato {

std::vector<std::optional<Rigid3>> RigCalibration::PosesInFirst() const {
  std::vector<std::optional<Rigid3>> poses = {Rigid3{}};
  for (size_t n = 1; n < cameras.size(); ++n) {
    if (!on_imu.empty()) {
      poses.emplace_back(on_imu[0].T_c_i * on_imu[n].T_c_i.Inverse());
    } else if (poses.back() && cameras[n].T_cn_cnm1) {
      poses.emplace_back(*poses.back() * cameras[n].T_cn_cnm1->Inverse());
    } else {
      poses.emplace_back(std::nullopt);
    }
  }
  return poses;
}

RigCalibration RigCalibrationFromValues(const Value& result, const Value& chain,
                                        const Value* imus) {
  RigCalibration rig;
  rig.cameras = CameraChainFromValue(chain, nullptr);
  if (imus == nullptr) return rig;
  const Value::Elements& cameras = result.At("cameras").elements();
  if (cameras.size() != rig.cameras.size()) {
    result.At("cameras").Fail("result.json and the camera chain are not of one calibration",
                              "one has " + std::to_string(cameras.size()) + " cameras, the other " +
                                  std::to_string(rig.cameras.size()),
                              "calibrate again");
  }
  for (size_t n = 0; n < cameras.size(); ++n) {
    const Value& camera = chain.At("cam" + std::to_string(n));
    const Value* line_delay = cameras[n].Find("line_delay_s");
    rig.on_imu.push_back({Rigid3FromValue(camera.At("T_cam_imu")),
                          camera.At("timeshift_cam_imu").AsDouble(),
                          line_delay == nullptr ? 0.0 : line_delay->AsDouble()});
  }
  const std::vector<Imu> all = ImusFromValue(*imus, nullptr);
  rig.imu = all.front();
  rig.num_imus = all.size();
  const Value::Elements& of_imus = result.At("imus").elements();
  if (of_imus.empty()) {
    result.At("imus").Fail("no IMU", "the list is empty", "calibrate again");
  }
  const Value& imu = of_imus.front();
  rig.gyro_bias = Eigen::Vector3d(imu.At("gyro_bias").AsDoubles(3).data());
  rig.accel_bias = Eigen::Vector3d(imu.At("accel_bias").AsDoubles(3).data());
  rig.gravity = Eigen::Vector3d(result.At("gravity_g").AsDoubles(3).data()).norm();
  return rig;
}

}  // namespace calibrato
