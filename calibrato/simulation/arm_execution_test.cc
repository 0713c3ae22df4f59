#include "calibrato/simulation/arm_execution.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/input_error.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/imu_simulation.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

const Vector3d kGravity_w(0.0, 0.0, -kStandardGravity);

TimedMotion OnArm(Motion motion) {
  motion.carrier = Carrier::kArm;
  return std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
}

const TimedMotion& Handcrafted() {
  static const TimedMotion motion = OnArm(HandcraftedMotion(Task::kExtrinsic));
  return motion;
}

ArmExecution Execute(const TimedMotion& motion, const Rig& rig = PaperRig(),
                     double step_s = 0.001) {
  const ArmScene scene(rig);
  Rng rng(1);
  return ExecuteOnArm(scene, rig, motion, rng, {.step_s = step_s});
}

void ExpectTracked(const ArmExecution& execution) {
  double position = 0.0;
  double rotation = 0.0;
  for (const Eigen::Vector2d& error : execution.tracking) {
    position = std::max(position, error[0]);
    rotation = std::max(rotation, error[1]);
  }
  EXPECT_LT(position, 0.005);
  EXPECT_LT(rotation, 0.5 * std::numbers::pi / 180.0);
  EXPECT_EQ(execution.num_saturated_steps, 0);
  double worst = 0.0;
  for (const JointVector& torque : execution.torque) {
    worst = std::max(worst, torque.cwiseAbs().cwiseQuotient(Limits().torque).maxCoeff());
  }
  EXPECT_LT(worst, 1.0);
  testing::Test::RecordProperty("tracking_mm", std::to_string(1e3 * position));
  if (FullSample()) {
    std::printf("off the plan by %.3f mm, %.4f degrees; torques up to %.0f %% of the limits\n",
                1e3 * position, rotation * 180.0 / std::numbers::pi, 100.0 * worst);
  }
}

TEST(ArmExecution, TracksTheHandcraftedMotion) { ExpectTracked(Execute(Handcrafted())); }

TEST(ArmExecution, TracksRandomMotions) {
  const int num_motions = FullSample() ? 100 : 3;
  Rng rng(5);
  for (int i = 0; i < num_motions; ++i) {
    ExpectTracked(
        Execute(OnArm(RandomMotion(i % 2 == 0 ? Task::kIntrinsic : Task::kExtrinsic, rng))));
  }
}

// What is thrown instead of an execution; empty if nothing is.
std::string RefusalOn(const ArmScene& scene, const ArmControl& control) {
  Rng rng(1);
  try {
    (void)ExecuteOnArm(scene, PaperRig(), Handcrafted(), rng, {.control = &control});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// MuJoCo itself would end the program.
TEST(ArmExecution, SaysWhatMujocoGivesUpAt) {
  const ArmScene scene(PaperRig());
  const auto stack = scene.data()->nstack;
  scene.data()->nstack = 50;
  const std::string refusal = RefusalOn(scene, PandaControl());
  EXPECT_NE(refusal.find("MuJoCo gives up"), std::string::npos) << refusal;
  EXPECT_EQ(refusal.find('\n'), std::string::npos) << refusal;
  // And goes on with the next one.
  scene.data()->nstack = stack;
  EXPECT_EQ(RefusalOn(scene, PandaControl()), "");
}

// MuJoCo itself would warn, switch the motors off or set the arm back, and go on.
TEST(ArmExecution, RefusesWhatMujocoWarnsOf) {
  ArmControl broken = PandaControl();
  broken.proportional[2] = std::nan("");
  const std::string refusal = RefusalOn(ArmScene(PaperRig()), broken);
  EXPECT_NE(refusal.find("the arm does not follow the motion"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("at 0.000000 s"), std::string::npos) << refusal;
}

TEST(ArmExecution, AtRestTheImuFeelsGravityAlone) {
  Motion still;
  still.loops.resize(1);
  const Rig rig = PaperRig();
  const ArmExecution execution = Execute(OnArm(still));
  const CarrierPath path = PathOf(execution, 5.0);
  for (size_t k = 0; k < execution.gyro.size(); k += 100) {
    EXPECT_NEAR(execution.accel[k].norm(), kStandardGravity, 1e-8);
    EXPECT_LT(execution.gyro[k].norm(), 1e-9);
    const ImuMotion motion = ImuMotionAt(rig, path, static_cast<double>(k) * execution.step_s);
    EXPECT_NEAR(SpecificForce(motion, kGravity_w).norm(), kStandardGravity, 1e-7);
  }
}

// Largest difference, over the motion, of MuJoCo's sensors to the derivatives of the path that the
// simulation took.
struct SensorError {
  double gyro = 0.0;
  double accel = 0.0;
};
SensorError ErrorOfSensors(double step_s) {
  const Rig rig = PaperRig();
  const ArmExecution execution = Execute(Handcrafted(), rig, step_s);
  const CarrierPath path = PathOf(execution, Handcrafted().duration_s());
  SensorError error;
  for (double t_s = 0.5; t_s < 14.5; t_s += 0.01) {
    const auto k = static_cast<size_t>(std::lround(t_s / step_s));
    const ImuMotion motion = ImuMotionAt(rig, path, static_cast<double>(k) * step_s);
    error.gyro = std::max(error.gyro, (execution.gyro[k] - motion.omega_i).norm());
    error.accel =
        std::max(error.accel, (execution.accel[k] - SpecificForce(motion, kGravity_w)).norm());
  }
  return error;
}

// Semi-implicit Euler is of first order: half the step, half the error.
TEST(ArmExecution, MujocosImuConvergesToTheDerivativesOfThePathWithTheStep) {
  const SensorError coarse = ErrorOfSensors(0.001);
  const SensorError fine = ErrorOfSensors(0.0005);
  const SensorError finest = ErrorOfSensors(0.00025);
  EXPECT_LT(coarse.gyro, 0.01);
  EXPECT_LT(coarse.accel, 0.05);
  for (const double ratio : {coarse.gyro / fine.gyro, fine.gyro / finest.gyro,
                             coarse.accel / fine.accel, fine.accel / finest.accel}) {
    EXPECT_GT(ratio, 1.8);
    EXPECT_LT(ratio, 2.2);
  }
}

TEST(ArmExecution, ThePathItselfConvergesWithTheStep) {
  const CarrierPath coarse = PathOf(Execute(Handcrafted(), PaperRig(), 0.002), 15.0);
  const CarrierPath fine = PathOf(Execute(Handcrafted(), PaperRig(), 0.001), 15.0);
  const CarrierPath finest = PathOf(Execute(Handcrafted(), PaperRig(), 0.0005), 15.0);
  double coarse_error = 0.0;
  double fine_error = 0.0;
  for (double t_s = 0.1; t_s < 15.0; t_s += 0.05) {
    const Vector3d best = finest.at(t_s).T_b_e.t;
    coarse_error = std::max(coarse_error, (coarse.at(t_s).T_b_e.t - best).norm());
    fine_error = std::max(fine_error, (fine.at(t_s).T_b_e.t - best).norm());
  }
  EXPECT_LT(coarse_error, 1e-4);
  // Errors of first order, h - h/4 and h/2 - h/4: three to one.
  EXPECT_NEAR(coarse_error / fine_error, 3.0, 0.4);
}

TEST(PathOf, RatesAndAccelerationsAreItsDerivatives) {
  const CarrierPath path = PathOf(Execute(Handcrafted()), 15.0);
  constexpr double kStep = 1e-5;
  for (double t_s = 0.20013; t_s < 14.9; t_s += 0.251) {
    const CarrierState before = path.at(t_s - kStep);
    const CarrierState state = path.at(t_s);
    const CarrierState after = path.at(t_s + kStep);
    EXPECT_LT(((after.T_b_e.t - before.T_b_e.t) / (2.0 * kStep) - state.velocity_b).norm(), 1e-6);
    EXPECT_LT(
        ((after.velocity_b - before.velocity_b) / (2.0 * kStep) - state.acceleration_b).norm(),
        1e-4);
    EXPECT_LT(((after.angular_velocity_b - before.angular_velocity_b) / (2.0 * kStep) -
               state.angular_acceleration_b)
                  .norm(),
              1e-4);
  }
}

TEST(PathOf, RestsBeforeAndAfterTheMotion) {
  const CarrierPath path = PathOf(Execute(Handcrafted()), 15.0);
  EXPECT_LT((path.at(-1.0).T_b_e.t - path.at(0.0).T_b_e.t).norm(), 1e-12);
  EXPECT_LT(path.at(-1.0).velocity_b.norm(), 1e-9);
  EXPECT_LT(path.at(100.0).velocity_b.norm(), 1e-4);
}

// Gears of 15 Hz: after the last jerk, at the end of a motion, the hand goes on swinging at that
// frequency, and less and less.
TEST(ArmExecution, ElasticGearsSwingAtTheirFrequency) {
  Rig rig = PaperRig();
  const ArmExecution stiff = Execute(Handcrafted(), rig);
  rig.arm_disturbances = {.mode_hz = 15.0, .mode_damping = 0.03, .torque_ripple = 0.0};
  const ArmExecution elastic = Execute(Handcrafted(), rig);
  // Zero crossings of the deflection's swing in the last 0.18 s, at rest but for it.
  int num_crossings = 0;
  double first_s = 0.0;
  double last_s = 0.0;
  for (size_t k = 15'020; k + 1 < elastic.position.size(); ++k) {
    const double a = elastic.position[k][1] - stiff.position[k][1];
    const double b = elastic.position[k + 1][1] - stiff.position[k + 1][1];
    if ((a < 0.0) == (b < 0.0)) continue;
    last_s = (static_cast<double>(k) + a / (a - b)) * elastic.step_s;
    if (num_crossings++ == 0) first_s = last_s;
  }
  ASSERT_GE(num_crossings, 4);
  EXPECT_NEAR(0.5 * (num_crossings - 1) / (last_s - first_s), 15.0, 1.0);
}

TEST(ArmExecution, RippleShakesTheMovingArmAndLeavesItAloneAtRest) {
  Rig rig = PaperRig();
  const ArmExecution smooth = Execute(Handcrafted(), rig);
  rig.arm_disturbances.torque_ripple = 2.0;
  const ArmExecution rippled = Execute(Handcrafted(), rig);
  const auto shake = [&](size_t from, size_t to) {
    double sum = 0.0;
    for (size_t k = from; k < to; ++k) sum += (rippled.accel[k] - smooth.accel[k]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(to - from));
  };
  EXPECT_GT(shake(2000, 3000), 0.05);
  EXPECT_LT(shake(15'150, 15'190), 0.02 * shake(2000, 3000));
}

TEST(ArmExecution, IsTheSameForTheSameSeed) {
  Rig rig = PaperRig();
  rig.arm_disturbances = {.mode_hz = 20.0, .mode_damping = 0.05, .torque_ripple = 1.0};
  const ArmExecution first = Execute(Handcrafted(), rig);
  const ArmExecution second = Execute(Handcrafted(), rig);
  EXPECT_EQ(first.position, second.position);
}

TEST(ArmExecution, RefusesAnArmThatDoesNotFollow) {
  // Slack controllers: the arm swings away from the plan and over a joint's limit.
  const ArmScene scene(PaperRig());
  ArmControl wrong = PandaControl();
  wrong.proportional *= -1.0;
  Rng rng(1);
  EXPECT_THROW((void)ExecuteOnArm(scene, PaperRig(), Handcrafted(), rng,
                                  {.step_s = 0.001, .control = &wrong}),
               InputError);
}

}  // namespace
}  // namespace calibrato
