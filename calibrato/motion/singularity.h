#pragma once

#include <string>

#include "calibrato/motion/panda.h"

namespace calibrato {

/// How far joint angles are from a singularity: the least singular value of the Jacobian of pose by
/// joints, angles in rad and lengths in m. Where it is s, some motion of the hand of 1 (rad/s, m/s)
/// needs 1 / s rad/s of the joints; at 0 they can't make it at all. In the arm's usual postures it
/// is 0.1 to 0.2.
[[nodiscard]] double SingularityDistance(const JointVector& q);

/// A path must stay so far from singularities: at this distance 20 mm/s of the hand may take 1
/// rad/s of the joints.
inline constexpr double kMinSingularityDistance = 0.02;

/// What is nearest to be singular: "elbow" (stretched, joint 4), "wrist" (axes 5 and 7 in line,
/// joint 6), "shoulder" (axes 1 and 3 in line, joint 2).
[[nodiscard]] std::string SingularPart(const JointVector& q);

}  // namespace calibrato
