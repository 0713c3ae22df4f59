#include "calibrato/simulation/arm_execution.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

constexpr double kAfterwards = 0.2;  // [s]

// The links on elastic gears, e = link - motor: e'' + 2 zeta w e' + w^2 e = -(acceleration of the
// motors), by the exact solution for an acceleration that stays the same during a step.
class ElasticGears {
 public:
  ElasticGears(const ArmDisturbances& arm, double step_s)
      : omega_(2.0 * std::numbers::pi * arm.mode_hz), decay_(arm.mode_damping * omega_) {
    const double swing = omega_ * std::sqrt(1.0 - arm.mode_damping * arm.mode_damping);
    const double c = std::cos(swing * step_s);
    const double s = std::sin(swing * step_s) / swing;
    const double fade = std::exp(-decay_ * step_s);
    // [e, e'] one step later.
    step_ << fade * (c + decay_ * s), fade * s, -fade * omega_ * omega_ * s,
        fade * (c - decay_ * s);
  }

  JointVector Deflection(const JointVector& motor_acceleration) {
    const JointVector at_rest = -motor_acceleration / (omega_ * omega_);
    const JointVector e = deflection_ - at_rest;
    deflection_ = at_rest + step_(0, 0) * e + step_(0, 1) * velocity_;
    velocity_ = step_(1, 0) * e + step_(1, 1) * velocity_;
    return deflection_;
  }

 private:
  double omega_;
  double decay_;
  Eigen::Matrix2d step_;
  JointVector deflection_ = JointVector::Zero();
  JointVector velocity_ = JointVector::Zero();
};

// The positions of the links, given those of the motors.
std::vector<JointVector> OnElasticGears(const std::vector<JointVector>& motors,
                                        const ArmDisturbances& arm, double step_s) {
  ElasticGears gears(arm, step_s);
  std::vector<JointVector> links = motors;
  for (size_t k = 1; k + 1 < motors.size(); ++k) {
    const JointVector acceleration =
        (motors[k + 1] - 2.0 * motors[k] + motors[k - 1]) / (step_s * step_s);
    links[k + 1] = motors[k + 1] + gears.Deflection(acceleration);
  }
  return links;
}

void CheckState(const JointVector& q, double t_s) {
  const JointVector beyond = (q - Limits().upper).cwiseMax(Limits().lower - q);
  Eigen::Index joint = 0;
  const double worst = beyond.maxCoeff(&joint);
  if (!(worst <= 0.0)) {
    throw InputError({"the arm does not follow the motion", "",
                      "joint " + std::to_string(joint + 1) + " breaks its limit at " +
                          std::to_string(t_s) + " s",
                      "make the motion slower or smaller"});
  }
}

// MuJoCo counts what it warns of, and goes on: with a state that it has set back, or with motors
// that it has switched off.
void CheckWarnings(const mjData* data, double t_s) {
  for (int kind = 0; kind < mjNWARNING; ++kind) {
    const mjWarningStat& warning = data->warning[kind];
    if (warning.number == 0) continue;
    throw InputError(
        {"the arm does not follow the motion", "",
         std::string(mju_warningText(kind, warning.lastinfo)) + " at " + std::to_string(t_s) + " s",
         "make the motion slower or smaller"});
  }
}

Eigen::Vector2d TrackingError(const JointVector& q, const Rigid3& wanted) {
  const Eigen::Matrix<double, 6, 1> error = PandaPose(q, nullptr).DifferenceTo(wanted);
  return {error.tail<3>().norm(), error.head<3>().norm()};
}

// Value and two derivatives at u in [0, 1] of the polynomial of degree 5 with given value p, slope
// v and curvature a at u = 0 and 1; by u.
struct Quintic {
  double p0, v0, a0, p1, v1, a1;

  [[nodiscard]] Vector3d At(double u) const {
    const double rise = p1 - p0 - v0 - 0.5 * a0;
    const double slope = v1 - v0 - a0;
    const double bend = a1 - a0;
    const double c3 = 10.0 * rise - 4.0 * slope + 0.5 * bend;
    const double c4 = -15.0 * rise + 7.0 * slope - bend;
    const double c5 = 6.0 * rise - 3.0 * slope + 0.5 * bend;
    return {p0 + u * (v0 + u * (0.5 * a0 + u * (c3 + u * (c4 + u * c5)))),
            v0 + u * (a0 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5))),
            a0 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))};
  }
};

JointMotion JointsAt(const std::vector<JointVector>& position, double step_s, double t_s) {
  const auto last = static_cast<int>(position.size()) - 1;
  const double steps = std::clamp(t_s / step_s, 0.0, static_cast<double>(last));
  const int k = std::min(static_cast<int>(steps), last - 1);
  const auto at = [&](int i) -> const JointVector& { return position[std::clamp(i, 0, last)]; };
  JointMotion joints;
  for (int i = 0; i < 7; ++i) {
    const double before = at(k - 1)[i];
    const double p0 = at(k)[i];
    const double p1 = at(k + 1)[i];
    const double after = at(k + 2)[i];
    const Vector3d x = Quintic{p0, 0.5 * (p1 - before), p1 - 2.0 * p0 + before,
                               p1, 0.5 * (after - p0),  after - 2.0 * p1 + p0}
                           .At(steps - k);
    joints.position[i] = x[0];
    joints.velocity[i] = x[1] / step_s;
    joints.acceleration[i] = x[2] / (step_s * step_s);
  }
  joints.jerk.setZero();  // not looked at
  return joints;
}

// What the arm is to do: at rest before and after it.
struct Wanted {
  double duration_s;
  std::function<JointMotion(double t_s)> joints;
  std::function<Rigid3(double t_s)> pose;  // T_b_e, that tracking is judged by
};

ArmExecution Execute(const ArmScene& scene, const Rig& rig, const Wanted& wanted, Rng& rng,
                     const ArmExecutionOptions& options) {
  mjModel* model = scene.model();
  mjData* data = scene.data();
  const ArmControl& control = *options.control;
  const double step_s = options.step_s;
  model->opt.timestep = step_s;
  mj_resetData(model, data);
  Eigen::Map<JointVector>(data->qpos) = wanted.joints(0.0).position;

  const int gyro = model->sensor_adr[mj_name2id(model, mjOBJ_SENSOR, "gyroscope")];
  const int accel = model->sensor_adr[mj_name2id(model, mjOBJ_SENSOR, "accelerometer")];
  ArmExecution execution;
  execution.step_s = step_s;
  JointVector integral = JointVector::Zero();
  const auto num_steps = static_cast<int>(std::ceil((wanted.duration_s + kAfterwards) / step_s));
  for (int k = 0; k <= num_steps; ++k) {
    const double t_s = k * step_s;
    mj_step1(model, data);
    const JointVector q = Eigen::Map<const JointVector>(data->qpos);
    const JointVector velocity = Eigen::Map<const JointVector>(data->qvel);
    CheckState(q, t_s);
    const JointMotion goal = wanted.joints(t_s);
    const JointVector error = goal.position - q;
    JointVector torque = Eigen::Map<const JointVector>(data->qfrc_bias) +
                         control.proportional.cwiseProduct(error) +
                         control.integral.cwiseProduct(integral) +
                         control.derivative.cwiseProduct(goal.velocity - velocity);
    const JointVector cut = torque.cwiseMax(-Limits().torque).cwiseMin(Limits().torque);
    if (cut == torque) {
      integral += step_s * error;
    } else {
      ++execution.num_saturated_steps;
    }
    execution.torque.push_back(cut);
    // Drawn for every setting alike.
    JointVector ripple;
    for (double& x : ripple) x = rng.Normal();
    ripple = rig.arm_disturbances.torque_ripple * ripple.cwiseProduct(velocity);
    Eigen::Map<JointVector>(data->ctrl) = cut;
    Eigen::Map<JointVector>(data->qfrc_applied) = ripple;
    mj_step2(model, data);
    CheckWarnings(data, t_s);
    execution.position.push_back(q);
    execution.gyro.emplace_back(Eigen::Map<const Vector3d>(data->sensordata + gyro));
    execution.accel.emplace_back(Eigen::Map<const Vector3d>(data->sensordata + accel));
  }
  if (rig.arm_disturbances.mode_hz > 0.0) {
    execution.position = OnElasticGears(execution.position, rig.arm_disturbances, step_s);
  }
  for (size_t k = 0; k < execution.position.size(); ++k) {
    execution.tracking.push_back(
        TrackingError(execution.position[k], wanted.pose(static_cast<double>(k) * step_s)));
  }
  return execution;
}

}  // namespace

const ArmControl& PandaControl() {
  static const ArmControl control = [] {
    ArmControl c;
    c.proportional << 12000.0, 12000.0, 8000.0, 8000.0, 3000.0, 3000.0, 2000.0;
    c.integral << 20000.0, 20000.0, 12000.0, 12000.0, 5000.0, 5000.0, 3000.0;
    c.derivative << 200.0, 200.0, 120.0, 120.0, 40.0, 40.0, 25.0;
    return c;
  }();
  return control;
}

ArmExecution ExecuteOnArm(const ArmScene& scene, const Rig& rig, const TimedMotion& motion,
                          Rng& rng, const ArmExecutionOptions& options) {
  const JointTrajectory trajectory(motion);
  const Wanted wanted{motion.duration_s(), [&](double t_s) { return trajectory.At(t_s); },
                      [&](double t_s) { return motion.At(t_s).T_b_e; }};
  return Execute(scene, rig, wanted, rng, options);
}

ArmExecution ExecuteCommands(const ArmScene& scene, const Rig& rig,
                             const std::vector<JointVector>& commands, Rng& rng,
                             const ArmExecutionOptions& options) {
  assert(commands.size() > 3);
  constexpr double kCycle = 1e-3;  // [s]
  const auto joints = [&](double t_s) { return JointsAt(commands, kCycle, t_s); };
  const Wanted wanted{kCycle * static_cast<double>(commands.size() - 1), joints,
                      [&](double t_s) { return PandaPose(joints(t_s).position, nullptr); }};
  return Execute(scene, rig, wanted, rng, options);
}

CarrierPath PathOf(const ArmExecution& execution, double duration_s) {
  assert(execution.position.size() > 3);
  const auto position = std::make_shared<const std::vector<JointVector>>(execution.position);
  return {duration_s,
          [position, step_s = execution.step_s](double t_s) {
            return CarrierStateOf(JointsAt(*position, step_s, t_s));
          },
          [position, step_s = execution.step_s](double t_s) {
            return JointsAt(*position, step_s, t_s).position;
          }};
}

}  // namespace calibrato
