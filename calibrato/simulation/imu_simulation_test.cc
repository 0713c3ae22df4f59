#include "calibrato/simulation/imu_simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

const Vector3d kGravity_w(0.0, 0.0, -kStandardGravity);
const Time kStart = Time::FromNanoseconds(1'600'000'000'000'000'000);

ImuNoise NoNoise() { return {200.0, 0.0, 0.0, 0.0, 0.0}; }

TimedMotion Plan(const Motion& motion, const Rig& rig) {
  return std::get<TimedMotion>(PlanMotion(motion, rig));
}

TimedMotion Handcrafted(const Rig& rig) { return Plan(HandcraftedMotion(Task::kExtrinsic), rig); }

Motion Still() {
  Motion motion;
  motion.loops.resize(1);
  return motion;
}

ImuMotion AtRest(double /*t_s*/) {
  return {Eigen::Matrix3d::Identity(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
}

// A turntable about the vertical at 1 rad/s and, on top of it, rates that swing with `hz`.
ImuMotion Swinging(double t_s, double hz) {
  const double w = 2.0 * std::numbers::pi * hz;
  ImuMotion motion = AtRest(t_s);
  motion.omega_i = {std::sin(w * t_s), 0.0, 1.0};
  return motion;
}

SimulatedImu Simulate(const std::function<ImuMotion(double)>& motion_at, double duration_s,
                      const ImuNoise& noise, const ImuDisturbances& disturbances = {},
                      uint64_t seed = 1) {
  Rng rng(seed);
  return SimulateImu(motion_at, duration_s, kGravity_w, noise, disturbances, kStart, rng);
}

Rigid3 PoseOfImu(const Rig& rig, const TimedMotion& motion, double t_s) {
  return ArmBaseInWorld() * motion.At(t_s).T_b_e * rig.T_e_c0 * rig.T_c0_i;
}

// The poses alone, differentiated numerically, give the same rates and accelerations: by central
// differences of fourth order, whose error at 2 ms is below 1e-7 of what is compared.
TEST(ImuMotion, IsTheDerivativeOfThePosePath) {
  const Rig rig = PaperRig();
  const TimedMotion motion = Handcrafted(rig);
  constexpr double kStep = 2e-3;
  const auto omega_i = [&](double t_s) -> Vector3d {
    const auto turn = [&](double h) -> Vector3d {
      return LogSo3(PoseOfImu(rig, motion, t_s - h).R.transpose() *
                    PoseOfImu(rig, motion, t_s + h).R) /
             (2.0 * h);
    };
    return (4.0 * turn(0.5 * kStep) - turn(kStep)) / 3.0;
  };
  for (const double t_s : {0.7, 1.9, 3.3, 6.1, 8.4, 12.6}) {
    const ImuMotion state = ImuMotionAt(rig, motion, t_s);
    EXPECT_LT((state.R_w_i - PoseOfImu(rig, motion, t_s).R).norm(), 1e-14);
    EXPECT_LT((state.omega_i - omega_i(t_s)).norm(), 1e-6) << t_s;
    const Vector3d alpha_i = (omega_i(t_s + kStep) - omega_i(t_s - kStep)) / (2.0 * kStep);
    EXPECT_LT((state.alpha_i - alpha_i).norm(), 1e-3 * std::max(1.0, state.alpha_i.norm()));
    const auto second = [&](double h) -> Vector3d {
      return (PoseOfImu(rig, motion, t_s + h).t - 2.0 * PoseOfImu(rig, motion, t_s).t +
              PoseOfImu(rig, motion, t_s - h).t) /
             (h * h);
    };
    const Vector3d accel_w = (4.0 * second(0.5 * kStep) - second(kStep)) / 3.0;
    EXPECT_LT((state.accel_w - accel_w).norm(), 1e-6) << t_s;
    EXPECT_GT(state.omega_i.norm() + state.accel_w.norm(), 0.01) << "nothing moves at " << t_s;
  }
}

// Rates and forces, integrated from the first pose on, stay on the path and lead back to where it
// began.
TEST(SimulateImu, IntegratesToThePath) {
  Rig rig = PaperRig();
  rig.imu_noise = NoNoise();
  rig.imu_noise.rate_hz = 1000.0;
  const TimedMotion motion = Handcrafted(rig);
  Rng rng(1);
  const ImuStream stream = SimulateImu(rig, motion, kStart, rng).stream;
  const double dt = 1e-3;
  Eigen::Matrix3d R_w_i = PoseOfImu(rig, motion, 0.0).R;
  Vector3d velocity_w = Vector3d::Zero();
  Vector3d position_w = PoseOfImu(rig, motion, 0.0).t;
  for (size_t k = 0; k + 1 < stream.gyro.size(); ++k) {
    if (k % 500 == 0) {
      const Rigid3 truth = PoseOfImu(rig, motion, dt * static_cast<double>(k));
      EXPECT_LT(LogSo3(R_w_i.transpose() * truth.R).norm(), 1e-6) << k;
      EXPECT_LT((position_w - truth.t).norm(), 1e-4) << k;
    }
    const Vector3d turn = 0.5 * dt * (stream.gyro[k].value + stream.gyro[k + 1].value);
    const Eigen::Matrix3d R_next = R_w_i * ExpSo3(turn);
    const Vector3d a_now = R_w_i * stream.accel[k].value + kGravity_w;
    const Vector3d a_next = R_next * stream.accel[k + 1].value + kGravity_w;
    position_w += dt * velocity_w + dt * dt * (a_now / 3.0 + a_next / 6.0);
    velocity_w += 0.5 * dt * (a_now + a_next);
    R_w_i = R_next;
  }
  EXPECT_LT((position_w - PoseOfImu(rig, motion, 0.0).t).norm(), 1e-4);
}

TEST(SimulateImu, AtRestFeelsGravityAlone) {
  Rig rig = PaperRig();
  rig.imu_noise = NoNoise();
  const TimedMotion still = Plan(Still(), rig);
  Rng rng(1);
  const ImuStream stream = SimulateImu(rig, still, kStart, rng).stream;
  ASSERT_EQ(stream.gyro.size(), 1000U);
  const Vector3d up_i = PoseOfImu(rig, still, 0.0).R.transpose() * Vector3d(0.0, 0.0, 9.80665);
  for (size_t k = 0; k < stream.gyro.size(); k += 111) {
    EXPECT_EQ(stream.gyro[k].value, Vector3d(0.0, 0.0, 0.0));
    EXPECT_LT((stream.accel[k].value - up_i).norm(), 1e-14);
  }
}

TEST(SimulateImu, StampsFollowTheImusClock) {
  Rig rig = PaperRig();
  rig.time_offset_i_c = Duration::FromNanoseconds(7'300'000);
  const TimedMotion motion = Handcrafted(rig);
  Rng rng(1);
  const ImuStream stream = SimulateImu(rig, motion, kStart, rng).stream;
  EXPECT_EQ((stream.gyro[0].stamp - kStart).nanoseconds(), 7'300'000);
  EXPECT_EQ((stream.accel[200].stamp - stream.accel[0].stamp).nanoseconds(), 1'000'000'000);
  EXPECT_EQ(stream.gyro.size(), static_cast<size_t>(std::ceil(200.0 * motion.duration_s() - 1e-9)));

  // A fast clock: 100 s last 100.01 s on it, and what it stamps 50.005 s happened at 50 s.
  ImuDisturbances drifting;
  drifting.clock_drift_ppm = 100.0;
  const auto ramp = [](double t_s) {
    ImuMotion state = AtRest(t_s);
    state.omega_i.x() = t_s;
    return state;
  };
  const ImuStream fast = Simulate(ramp, 100.0, NoNoise(), drifting).stream;
  EXPECT_EQ(fast.gyro.size(), 20002U);
  EXPECT_EQ((fast.gyro[10001].stamp - kStart).nanoseconds(), 50'005'000'000);
  EXPECT_NEAR(fast.gyro[10001].value.x(), 50.0, 1e-9);
}

// White noise: the variance of the mean of m samples falls as density^2 rate / m, the variance of
// one difference of neighbours is twice that of a sample. Random walk: the bias wanders by walk
// sqrt(T). Bounds: four standard errors of a variance from that many draws.
TEST(SimulateImu, NoiseHasTheStatedDensities) {
  ImuNoise noise;
  noise.accel_random_walk = noise.gyro_random_walk = 0.0;
  const double duration_s = FullSample() ? 3600.0 : 200.0;
  const ImuStream stream = Simulate(AtRest, duration_s, noise).stream;
  const auto check = [&](const std::vector<VectorSample>& samples, const Vector3d& truth,
                         double density) {
    for (const size_t mean_of : {1, 10, 100}) {
      double sum = 0.0;
      double count = 0.0;
      for (size_t begin = 0; begin + mean_of <= samples.size(); begin += mean_of) {
        Vector3d mean = Vector3d::Zero();
        for (size_t k = begin; k < begin + mean_of; ++k) mean += samples[k].value - truth;
        sum += (mean / static_cast<double>(mean_of)).squaredNorm();
        count += 3.0;
      }
      const double expected = density * density * 200.0 / static_cast<double>(mean_of);
      EXPECT_NEAR(sum / count, expected, 4.0 * expected * std::sqrt(2.0 / count)) << mean_of;
    }
  };
  check(stream.gyro, Vector3d::Zero(), 2.40e-5);
  check(stream.accel, -kGravity_w, 2.83e-4);
}

TEST(SimulateImu, BiasesWalkWithTheStatedDensities) {
  ImuNoise noise;
  noise.accel_noise_density = noise.gyro_noise_density = 0.0;
  const double duration_s = FullSample() ? 3600.0 : 200.0;
  const SimulatedImu imu = Simulate(AtRest, duration_s, noise);
  const auto check = [&](const std::vector<VectorSample>& samples, double walk) {
    for (const size_t apart : {1, 20, 200}) {
      double sum = 0.0;
      double count = 0.0;
      for (size_t k = 0; k + apart < samples.size(); k += apart) {
        sum += (samples[k + apart].value - samples[k].value).squaredNorm();
        count += 3.0;
      }
      const double expected = walk * walk * static_cast<double>(apart) / 200.0;
      EXPECT_NEAR(sum / count, expected, 4.0 * expected * std::sqrt(2.0 / count)) << apart;
    }
  };
  check(imu.stream.gyro, 9.1e-7);
  check(imu.stream.accel, 1.41e-4);
  Vector3d mean = Vector3d::Zero();
  for (const VectorSample& sample : imu.stream.accel) mean += sample.value + kGravity_w;
  mean /= static_cast<double>(imu.stream.accel.size());
  EXPECT_LT((mean - imu.mean_accel_bias).norm(), 1e-10);
  EXPECT_GT(imu.mean_accel_bias.norm(), 1e-5);
}

// A first-order low-pass weakens a swing of frequency f by 1 / sqrt(1 + (f / fc)^2) and delays it
// by atan(f / fc) / (2 pi f): at f = 1 Hz and fc = 20 Hz by 7.951 ms, near its group delay of
// 7.958 ms.
TEST(SimulateImu, LowPassWeakensAndDelays) {
  ImuDisturbances filtered;
  filtered.low_pass_hz = 20.0;
  for (const double hz : {1.0, 5.0, 20.0}) {
    const double w = 2.0 * std::numbers::pi * hz;
    ImuNoise noise = NoNoise();
    noise.rate_hz = 1000.0;
    const ImuStream stream =
        Simulate([&](double t_s) { return Swinging(t_s, hz); }, 3.0, noise, filtered).stream;
    const double gain = 1.0 / std::sqrt(1.0 + hz * hz / 400.0);
    const double delay_s = std::atan(hz / 20.0) / w;
    for (size_t k = 1000; k < stream.gyro.size(); k += 37) {
      const double t_s = (stream.gyro[k].stamp - kStart).seconds();
      // The hold is linear between samples: (w dt)^2 / 12 of the swing is lost.
      EXPECT_NEAR(stream.gyro[k].value.x(), gain * std::sin(w * (t_s - delay_s)),
                  1e-4 + w * w * 1e-6 / 8.0);
      EXPECT_NEAR(stream.gyro[k].value.z(), 1.0, 1e-12);
      EXPECT_NEAR(stream.accel[k].value.z(), 9.80665, 1e-12);
    }
  }
}

TEST(SimulateImu, SaturatesAndRounds) {
  ImuDisturbances digital;
  digital.gyro_range = 0.7;
  digital.accel_range = 9.0;
  digital.gyro_resolution = 0.1;
  const ImuStream stream =
      Simulate([](double t_s) { return Swinging(t_s, 1.0); }, 1.0, NoNoise(), digital).stream;
  double highest = -1.0;
  for (size_t k = 0; k < stream.gyro.size(); ++k) {
    const double x = stream.gyro[k].value.x();
    const double truth = std::sin(2.0 * std::numbers::pi * static_cast<double>(k) / 200.0);
    EXPECT_NEAR(x, std::clamp(truth, -0.7, 0.7), 0.05 + 1e-12);
    EXPECT_NEAR(10.0 * x, std::round(10.0 * x), 1e-12);
    highest = std::max(highest, x);
    EXPECT_EQ(stream.accel[k].value.z(), 9.0);
  }
  EXPECT_NEAR(highest, 0.7, 1e-12);
}

TEST(SimulateImu, FaultsOfTheImuAreThoseOfItsModel) {
  Rig rig = PaperRig();
  rig.imu_noise = NoNoise();
  rig.imu_disturbances.intrinsics.M_accel(1, 0) = 0.02;
  rig.imu_disturbances.intrinsics.M_gyro(2, 2) = 1.03;
  rig.imu_disturbances.intrinsics.g_sensitivity(0, 1) = 1e-3;
  rig.imu_disturbances.intrinsics.lever_arms_i.col(2) << 0.01, 0.02, 0.0;
  rig.imu_disturbances.gyro_bias = {0.01, -0.02, 0.03};
  rig.imu_disturbances.accel_bias = {0.1, 0.2, -0.3};
  const TimedMotion motion = Handcrafted(rig);
  Rng rng(1);
  const SimulatedImu imu = SimulateImu(rig, motion, kStart, rng);
  EXPECT_LT((imu.mean_gyro_bias - rig.imu_disturbances.gyro_bias).norm(), 1e-14);
  for (size_t k = 0; k < imu.stream.gyro.size(); k += 301) {
    const ImuMotion state = ImuMotionAt(rig, motion, 0.005 * static_cast<double>(k));
    EXPECT_LT(
        (imu.stream.gyro[k].value - PredictGyro(state, kGravity_w, rig.imu_disturbances.intrinsics,
                                                rig.imu_disturbances.gyro_bias))
            .norm(),
        1e-12);
    EXPECT_LT((imu.stream.accel[k].value - PredictAccel(state, kGravity_w,
                                                        rig.imu_disturbances.intrinsics,
                                                        rig.imu_disturbances.accel_bias))
                  .norm(),
              1e-12);
  }
}

TEST(SimulateImu, SameSeedSameNumbersWhateverElseIsSwitchedOn) {
  const auto noise_of = [](const ImuDisturbances& disturbances, uint64_t seed) -> Vector3d {
    const SimulatedImu imu = Simulate(AtRest, 1.0, ImuNoise(), disturbances, seed);
    return imu.stream.gyro[150].value;
  };
  ImuDisturbances filtered;
  filtered.low_pass_hz = 30.0;
  EXPECT_EQ(noise_of({}, 1), noise_of({}, 1));
  EXPECT_LT((noise_of({}, 1) - noise_of(filtered, 1)).norm(), 1e-15);
  EXPECT_NE(noise_of({}, 1), noise_of({}, 2));
}

}  // namespace
}  // namespace calibrato
