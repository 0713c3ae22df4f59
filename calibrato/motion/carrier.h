#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "calibrato/motion/motion.h"
#include "calibrato/motion/time_law.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// The arm's base in the world: at the origin, turned by pi about z, as in the original's scene.
[[nodiscard]] Rigid3 ArmBaseInWorld();  // T_w_b

/// Where the controlled frame is and how it moves, at one instant; in the arm's base frame b.
struct CarrierState {
  Rigid3 T_b_e;
  Eigen::Vector3d velocity_b;              ///< [m/s]
  Eigen::Vector3d acceleration_b;          ///< [m/s^2]
  Eigen::Vector3d angular_velocity_b;      ///< [rad/s]
  Eigen::Vector3d angular_acceleration_b;  ///< [rad/s^2]
};

/// Joint angles at one instant of the motion.
struct JointSample {
  double t_s = 0.0;
  Eigen::Matrix<double, 7, 1> position;  ///< [rad]
};

/// A motion that its carrier can make, with its time law: each loop stretched by the smallest
/// factor >= 1 that keeps every velocity and acceleration within the carrier's limits, or, under
/// optimal timing, about as fast as they allow.
struct TimedMotion {
  Motion motion;                        ///< As planned: scaled, if scaling was allowed.
  double scale = 1.0;                   ///< What all coefficients were multiplied by, in (0, 1].
  std::vector<double> loop_duration_s;  ///< After stretching.
  /// How each loop's phase runs through that time: control points of TimeLaw. Empty for the
  /// quintic, and none at all where all loops are quintic.
  std::vector<std::vector<double>> loop_phase_control_points;
  /// Arm only: one sample a way-point, 62 a loop, the closing one last. The joint path is
  /// continuous over loops and every loop returns to the same joint angles.
  std::vector<JointSample> joint_path;

  /// @param laws  One a loop.
  void SetTimeLaws(const std::vector<TimeLaw>& laws);
  [[nodiscard]] TimeLaw LawOf(size_t loop) const;

  [[nodiscard]] double duration_s() const;
  /// @param t_s  In [0, duration_s()]; clamped outside.
  [[nodiscard]] CarrierState At(double t_s) const;
};

/// The way of the controlled frame through time, whoever says so: the plan, or the arm that
/// executed it. Before and after it the carrier is at rest.
struct CarrierPath {
  double duration_s = 0.0;
  std::function<CarrierState(double t_s)> at;
  std::function<Eigen::Matrix<double, 7, 1>(double t_s)> joints;  ///< [rad]; empty without an arm.
};
[[nodiscard]] CarrierPath PlannedPath(const TimedMotion& motion);

/// The motion with how it runs, for MOTION.yaml of a recording: beside what ToValue(Motion) gives,
/// scale, loop_duration_s, loop_phase_control_points_rad, joint_path_t_s_q_rad (docs/formats.md).
[[nodiscard]] Value ToValue(const TimedMotion& timed);

/// Why a carrier can't make a motion: the first limit broken, in the order of time. Never a partial
/// motion.
struct Refusal {
  std::string limit;   ///< "joint 4 lower limit", "reach from the shoulder", "board in view"
  int loop = 0;        ///< From 0.
  int way_point = 0;   ///< 1 to 62; theta = 2 pi way_point / 62.
  double value = 0.0;  ///< What the motion needs ...
  double bound = 0.0;  ///< ... and what the carrier has.
  std::string unit;
  int num_bad_way_points = 0;  ///< Of all loops' way-points ...
  int num_way_points = 0;      ///< ... of which there are so many.
  std::string remedy = "make it smaller, or add --scale-to-fit";  ///< What to try.
  /// "joint 4 lower limit at loop 3, way-point 17: -3.11 rad, allowed -3.07 rad (6 of 248
  /// way-points do not fit)"; loops counted from 1, for people.
  [[nodiscard]] std::string Describe() const;
};

/// The limits of the free carrier, a hand or a gantry (docs/simulation.md).
struct FreeCarrierLimits {
  double speed = 1.0;                  ///< [m/s]
  double acceleration = 3.0;           ///< [m/s^2]
  double angular_speed = 2.0;          ///< [rad/s]
  double angular_acceleration = 10.0;  ///< [rad/s^2]
  double reach = 0.75;                 ///< Of the controlled frame from the arm's shoulder [m].
  double min_height = 0.1;             ///< Of the controlled frame above the arm's base [m].
};

/// Where the free carrier's reach is measured from, in frame b: the Panda's second joint [m].
[[nodiscard]] Eigen::Vector3d FreeCarrierShoulder();

/// Plans the motion on its carrier. The board of the rig must stay in view: its centre in front of
/// camera 0 and inside the image at every way-point.
///
/// The arm has one joint more than a pose needs: that freedom is resolved over all loops together,
/// not point by point.
[[nodiscard]] std::variant<TimedMotion, Refusal> PlanMotion(const Motion& motion, const Rig& rig);

/// With all coefficients multiplied by the largest factor in (0, 1] that fits (to 1e-3), one for
/// the whole motion. Speed is met by stretching time, never by shrinking.
/// @throws InputError if not even the base pose fits.
[[nodiscard]] TimedMotion PlanScaledToFit(const Motion& motion, const Rig& rig);

}  // namespace calibrato
