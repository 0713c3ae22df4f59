#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "calibrato/geometry/rigid3.h"

namespace calibrato {

/// The Franka Panda: seven revolute joints, base frame b at its foot (z up), controlled frame e =
/// panda_link8, the flange. Lengths and modified (Craig's) Denavit-Hartenberg parameters are the
/// maker's:
///
///     joint      1      2      3       4       5       6      7     flange
///     alpha      0   -pi/2   pi/2    pi/2   -pi/2    pi/2   pi/2     0     [rad]
///     a          0      0      0   0.0825 -0.0825     0    0.088     0     [m]
///     d       0.333     0   0.316      0    0.384     0       0    0.107   [m]
using JointVector = Eigen::Matrix<double, 7, 1>;    ///< [rad]
using JointJacobian = Eigen::Matrix<double, 6, 7>;  ///< Rows: dtheta_b, dt_b as in Rigid3.

/// Positions and velocities are the data sheet's, and so are jerks and torques. Accelerations are
/// those that the original plans with, a quarter of the data sheet's.
struct PandaLimits {
  JointVector lower;         ///< [rad]
  JointVector upper;         ///< [rad]
  JointVector velocity;      ///< [rad/s]
  JointVector acceleration;  ///< [rad/s^2]
  JointVector jerk;          ///< [rad/s^3]
  JointVector torque;        ///< [N m]
};
[[nodiscard]] const PandaLimits& Limits();

/// Where the joints may be: the arm's own limits, or narrower ones.
struct JointRange {
  JointVector lower = Limits().lower;
  JointVector upper = Limits().upper;
};
/// How far the worst joint lies beyond its limit; negative inside all limits [rad].
[[nodiscard]] double JointLimitExcess(const JointVector& q, const JointRange& range = {});

/// Where the joints turn.
struct PandaAxes {
  std::array<Rigid3, 7> T_b_link;  ///< Of link k: z along the axis of joint k, turned by it.
  Rigid3 T_b_e;
};
[[nodiscard]] PandaAxes AxesOf(const JointVector& q);

/// T_b_e. @param J_pose_q  Of the pose's perturbation by the joint angles; may be null.
[[nodiscard]] Rigid3 PandaPose(const JointVector& q, JointJacobian* J_pose_q);

/// All joint angles that reach T_b_e with the last joint at q7: none to eight, in closed form, each
/// angle within pi of the middle of its limits, so some outside the limits. The arm's redundancy is
/// what q7 leaves open.
[[nodiscard]] std::vector<JointVector> PandaInverse(const Rigid3& T_b_e, double q7);

/// How far T_b_e lies beyond what the arm's links can span, for the last joint at q7: 0 where
/// PandaInverse has solutions [m].
[[nodiscard]] double PandaShortfall(const Rigid3& T_b_e, double q7);

/// Joint 4 where the arm is stretched out: its offsets make that -0.47, not 0 [rad].
[[nodiscard]] double StretchedElbow();

/// The joint angles near `q` that reach T_b_e to 1e-10, by Newton's method, damped near
/// singularities; nothing if it does not converge.
[[nodiscard]] std::optional<JointVector> PandaInverseNear(const Rigid3& T_b_e,
                                                          const JointVector& q);

/// Of unit length: the joint velocity that leaves the pose at rest. Its sign is arbitrary.
[[nodiscard]] JointVector PandaNullDirection(const JointJacobian& J_pose_q);

}  // namespace calibrato
