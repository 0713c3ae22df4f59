#pragma once

#include <Eigen/Core>
#include <array>

#include "calibrato/motion/panda.h"

namespace calibrato {

/// Mass and inertia of a rigid link.
struct LinkInertia {
  double mass;                   ///< [kg]
  Eigen::Vector3d centre_link;   ///< Of mass, in the frame of the link [m].
  Eigen::Matrix3d about_centre;  ///< Axes of the link's frame [kg m^2].
};

/// Links 1 to 7 in the frames of PandaAxes, the hand with its two fingers last, in the frame e.
///
/// Source: C. Gaz, M. Cognetti, A. Oliva, P. Robuffo Giordano, A. De Luca, "Dynamic Identification
/// of the Franka Emika Panda Robot With Retrieval of Feasible Parameters Using Penalty-Based
/// Optimization", IEEE RA-L 4(4), 2019, as the maker's model of the arm has them; the hand is the
/// maker's. What the fingers carry weighs nothing.
[[nodiscard]] const std::array<LinkInertia, 8>& PandaInertias();

/// Of every joint: the motor's inertia behind the gear [kg m^2] and viscous friction [N m s/rad],
/// round figures of the order that identifications of this arm report.
inline constexpr double kMotorInertia = 0.1;
inline constexpr double kViscousFriction = 1.0;

/// The torques that make the joints move so, in standard gravity [N m]: Newton and Euler's
/// recursion. Not modelled: dry friction, elastic gears.
[[nodiscard]] JointVector PandaTorque(const JointVector& q, const JointVector& velocity,
                                      const JointVector& acceleration);

}  // namespace calibrato
