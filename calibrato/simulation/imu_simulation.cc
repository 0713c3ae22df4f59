#include "calibrato/simulation/imu_simulation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace calibrato {
namespace {

using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;  // gyroscope, then accelerometer

// tau dy/dt + y = x, from one sample to the next.
class LowPass {
 public:
  LowPass(double cut_off_hz, double period_s)
      : is_on_(cut_off_hz > 0.0),
        periods_per_tau_(2.0 * std::numbers::pi * cut_off_hz * period_s),
        decay_(std::exp(-periods_per_tau_)) {}

  Vector6d operator()(const Vector6d& input) {
    if (!is_on_) return input;
    if (is_first_) {
      output_ = input;
      is_first_ = false;
    } else {
      output_ = decay_ * output_ + (1.0 - decay_) * input_ +
                (1.0 - (1.0 - decay_) / periods_per_tau_) * (input - input_);
    }
    input_ = input;
    return output_;
  }

 private:
  bool is_on_;
  bool is_first_ = true;
  double periods_per_tau_;
  double decay_;
  Vector6d input_ = Vector6d::Zero();
  Vector6d output_ = Vector6d::Zero();
};

Vector3d Draw(Rng& rng) {
  Vector3d x;
  for (double& coordinate : x) coordinate = rng.Normal();
  return x;
}

constexpr int kStepsPerFilteredSample = 5;

// What the digital output makes of a value.
Vector3d Digital(Vector3d value, double range, double resolution) {
  for (double& x : value) {
    x = std::clamp(x, -range, range);
    if (resolution > 0.0) x = resolution * std::round(x / resolution);
  }
  return value;
}

ImuMotion ImuOn(const Rig& rig, const CarrierState& state) {
  static const Eigen::Matrix3d R_w_b = ArmBaseInWorld().R;
  const Eigen::Matrix3d R_e_b = state.T_b_e.R.transpose();
  const ImuMotion motion_e{
      .R_w_i = R_w_b * state.T_b_e.R,
      .omega_i = R_e_b * state.angular_velocity_b,
      // omega x omega is zero: turning the derivative is deriving what was turned.
      .alpha_i = R_e_b * state.angular_acceleration_b,
      .accel_w = R_w_b * state.acceleration_b,
  };
  return MotionOfFrame(motion_e, rig.T_e_c0 * rig.T_c0_i);
}

}  // namespace

ImuMotion ImuMotionAt(const Rig& rig, const TimedMotion& motion, double t_s) {
  return ImuOn(rig, motion.At(t_s));
}

ImuMotion ImuMotionAt(const Rig& rig, const CarrierPath& path, double t_s) {
  return ImuOn(rig, path.at(t_s));
}

SimulatedImu SimulateImu(const std::function<ImuMotion(double t_s)>& motion_at, double duration_s,
                         const Vector3d& gravity_w, const ImuNoise& noise,
                         const ImuDisturbances& disturbances, Time start, Rng& rng) {
  assert(duration_s > 0.0);
  const double period_s = 1.0 / noise.rate_hz;
  const double ticks_per_s = 1.0 + 1e-6 * disturbances.clock_drift_ppm;
  const double gyro_stddev = noise.gyro_noise_density * std::sqrt(noise.rate_hz);
  const double accel_stddev = noise.accel_noise_density * std::sqrt(noise.rate_hz);
  const double gyro_walk = noise.gyro_random_walk * std::sqrt(period_s);
  const double accel_walk = noise.accel_random_walk * std::sqrt(period_s);
  const ImuDisturbances& d = disturbances;

  SimulatedImu imu{{}, Vector3d::Zero(), Vector3d::Zero()};
  // A filter works on what lies between samples too: it keeps vibrations from being folded down.
  const int steps_per_sample = d.low_pass_hz > 0.0 ? kStepsPerFilteredSample : 1;
  const double step_s = period_s / ticks_per_s / steps_per_sample;
  LowPass low_pass(d.low_pass_hz, step_s);
  Vector3d gyro_bias = d.gyro_bias;
  Vector3d accel_bias = d.accel_bias;
  for (int64_t k = 0;; ++k) {
    const Duration elapsed = Duration::FromSeconds(static_cast<double>(k) * period_s);
    const double t_s = elapsed.seconds() / ticks_per_s;
    if (!(t_s < duration_s)) break;
    // What the filter has seen since the sample before.
    Vector6d filtered;
    for (int i = k == 0 ? steps_per_sample - 1 : 0; i < steps_per_sample; ++i) {
      const int steps_ahead = steps_per_sample - 1 - i;
      const ImuMotion motion = motion_at(t_s - steps_ahead * step_s);
      Vector6d felt;
      felt << PredictGyro(motion, gravity_w, d.intrinsics, Vector3d::Zero()),
          PredictAccel(motion, gravity_w, d.intrinsics, Vector3d::Zero());
      filtered = low_pass(felt);
    }
    const Vector3d gyro = filtered.head<3>() + gyro_bias + gyro_stddev * Draw(rng);
    const Vector3d accel = filtered.tail<3>() + accel_bias + accel_stddev * Draw(rng);
    const Time stamp = start + elapsed;
    imu.stream.gyro.push_back({stamp, Digital(gyro, d.gyro_range, d.gyro_resolution)});
    imu.stream.accel.push_back({stamp, Digital(accel, d.accel_range, d.accel_resolution)});
    imu.mean_gyro_bias += gyro_bias;
    imu.mean_accel_bias += accel_bias;
    gyro_bias += gyro_walk * Draw(rng);
    accel_bias += accel_walk * Draw(rng);
  }
  const auto num_samples = static_cast<double>(imu.stream.gyro.size());
  imu.mean_gyro_bias /= num_samples;
  imu.mean_accel_bias /= num_samples;
  return imu;
}

SimulatedImu SimulateImu(const Rig& rig, const TimedMotion& motion, Time start, Rng& rng) {
  return SimulateImu(rig, PlannedPath(motion), start, rng);
}

SimulatedImu SimulateImu(const Rig& rig, const CarrierPath& path, Time start, Rng& rng) {
  return SimulateImu([&](double t_s) { return ImuMotionAt(rig, path, t_s); }, path.duration_s,
                     {0.0, 0.0, -kStandardGravity}, rig.imu_noise, rig.imu_disturbances,
                     start + rig.time_offset_i_c, rng);
}

}  // namespace calibrato
