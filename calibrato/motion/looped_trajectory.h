#pragma once

#include <Eigen/Core>

#include "calibrato/geometry/rigid3.h"

namespace calibrato {

/// The 36 coefficients of one closed loop: index 6 * dof + k, dof = x y z roll pitch yaw, k = cos1
/// sin1 cos2 sin2 cos4 sin4. At phase theta each degree of freedom is offset by
///
///     sum over q = 1, 2, 4 of a_q (cos(q theta) - 1) + b_q sin(q theta)        (paper,
///     section 3.2)
///
/// with the original implementation's sign (the paper writes 1 - cos; the sets of motions are the
/// same). After scaling: [m] for x y z, [rad] for roll pitch yaw.
using LoopCoefficients = Eigen::Matrix<double, 36, 1>;

/// x y z [m], roll pitch yaw [rad].
using PoseVector = Eigen::Matrix<double, 6, 1>;

/// An action, limited to +-0.015 (the learner), +-0.02 (random) or +-0.102 (the free carrier's
/// reach), is scaled by 1 for x y z, 2.5 for roll, 5 for pitch, 2.5 for yaw. (The paper's text puts
/// the 5 on yaw; only this order reproduces its path lengths.)
[[nodiscard]] LoopCoefficients ScaledAction(const LoopCoefficients& action);

/// Offset and its first and second derivative by the phase theta [rad].
struct LoopOffset {
  PoseVector value;
  PoseVector first;   ///< per rad
  PoseVector second;  ///< per rad^2
};
[[nodiscard]] LoopOffset LoopOffsetAt(const LoopCoefficients& coefficients, double theta);

/// The pose that offsets add to: position in the arm's base frame b, fixed-axis angles.
struct BasePose {
  Eigen::Vector3d xyz_m{0.4, 0.3, 0.47};
  Eigen::Vector3d rpy_rad{1.5708, 0.8, 1.5708};
  bool operator==(const BasePose&) const = default;
};

/// T_b_e of the controlled frame at phase theta: R = Rz(yaw) Ry(pitch) Rx(roll).
[[nodiscard]] Rigid3 LoopPoseAt(const BasePose& base, const LoopCoefficients& coefficients,
                                double theta);

}  // namespace calibrato
