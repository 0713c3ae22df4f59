#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/joint_motion.h"
#include "calibrato/sensors/rig.h"
#include "calibrato/simulation/arm_scene.h"

namespace calibrato {

/// Each joint's controller at the rate of the simulation:
///
///     torque = gravity and Coriolis forces + P e + I (integral of e) + D e',   e = wanted - is
///
/// cut off at the motor's limit; the integral waits while it is. The original's gains are of this
/// order; these damp each joint nearly critically.
struct ArmControl {
  JointVector proportional;  ///< [N m/rad]
  JointVector integral;      ///< [N m/(rad s)]
  JointVector derivative;    ///< [N m s/rad]
};
[[nodiscard]] const ArmControl& PandaControl();

/// What the arm did, one entry a time step, the first at t_s = 0.
struct ArmExecution {
  double step_s = 0.0;
  std::vector<JointVector> position;      ///< Behind the gears, where the links are [rad].
  std::vector<JointVector> torque;        ///< Of the motors [N m].
  std::vector<Eigen::Vector3d> gyro;      ///< MuJoCo's sensors in the frame of the IMU [rad/s],
  std::vector<Eigen::Vector3d> accel;     ///< [m/s^2].
  std::vector<Eigen::Vector2d> tracking;  ///< Off the plan: [m], [rad].
  int num_saturated_steps = 0;            ///< In which a motor was at its limit.
};

struct ArmExecutionOptions {
  double step_s = 0.001;
  const ArmControl* control = &PandaControl();
};

/// Executes a motion that was planned on the arm: MuJoCo's dynamics (semi-implicit Euler), the
/// controller above. Starts at rest at the base pose, and goes on for 0.2 s after the motion's end.
///
/// The rig's arm_disturbances ripple the torques and let the links swing on their gears; both move
/// camera and IMU together, and the truth is what the links did.
/// @throws InputError if the arm does not follow: a joint limit is broken, or MuJoCo warns or gives
/// up (a state that diverges, no memory).
[[nodiscard]] ArmExecution ExecuteOnArm(const ArmScene& scene, const Rig& rig,
                                        const TimedMotion& motion, Rng& rng,
                                        const ArmExecutionOptions& options = {});

/// The same from nothing but the joint positions that the arm is told, one a millisecond, as its
/// controller gets them: between two of them it heads for the polynomial of PathOf.
/// @param commands  [rad], at rest at both ends; four or more.
[[nodiscard]] ArmExecution ExecuteCommands(const ArmScene& scene, const Rig& rig,
                                           const std::vector<JointVector>& commands, Rng& rng,
                                           const ArmExecutionOptions& options = {});

/// The way of the controlled frame, continuous up to its accelerations: between two steps each
/// joint follows the polynomial of degree 5 through the positions of both, with the velocities and
/// accelerations that central differences of the steps give. Pose, rates and accelerations are
/// exact derivatives of one another, which MuJoCo's own sensors are only to first order in the
/// step.
[[nodiscard]] CarrierPath PathOf(const ArmExecution& execution, double duration_s);

}  // namespace calibrato
