#include "calibrato/calibration/camera_imu_state.h"

#include <algorithm>
#include <cmath>

namespace calibrato {

ImuBias CameraImuState::BiasAt(int imu, double t_s) const {
  const std::vector<ImuBias>& biases = imus[static_cast<size_t>(imu)].biases;
  const double knot = t_s / block_duration_s();
  const double last = static_cast<double>(biases.size()) - 2.0;
  const auto before = static_cast<size_t>(std::clamp(std::floor(knot), 0.0, last));
  const double u = knot - static_cast<double>(before);
  const ImuBias& a = biases[before];
  const ImuBias& b = biases[before + 1];
  return {(1.0 - u) * a.gyro + u * b.gyro, (1.0 - u) * a.accel + u * b.accel};
}

ImuBias MeanBias(const ImuCalibrationState& imu) {
  ImuBias mean;
  for (const ImuBias& bias : imu.biases) {
    mean.gyro += bias.gyro / static_cast<double>(imu.biases.size());
    mean.accel += bias.accel / static_cast<double>(imu.biases.size());
  }
  return mean;
}

CameraImuState StateAlong(const std::function<Rigid3(double t_s)>& pose_g_i, Time start,
                          double duration_s, double knot_spacing_s, int spline_order,
                          const Eigen::Vector3d& gravity_g,
                          std::vector<CameraCalibrationState> cameras, size_t num_imus) {
  const int points_per_block = spline_order - 1;
  const int num_blocks = NumSegments(duration_s, points_per_block * knot_spacing_s);
  const double spacing = duration_s / (points_per_block * num_blocks);
  ImuCalibrationState imu;
  imu.biases.resize(static_cast<size_t>(num_blocks) + 1);
  return {start, SplineAlong(pose_g_i, spline_order, spacing, duration_s), gravity_g,
          std::move(cameras), std::vector<ImuCalibrationState>(num_imus, imu)};
}

}  // namespace calibrato
