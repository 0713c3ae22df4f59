#pragma once

#include "calibrato/motion/carrier.h"
#include "calibrato/motion/time_law.h"

namespace calibrato {

/// Pose, velocity and acceleration of the controlled frame at a phase of a loop that runs with
/// phase.first [rad/s] and phase.second [rad/s^2]; analytic.
[[nodiscard]] CarrierState LoopStateAt(const BasePose& base, const LoopCoefficients& coefficients,
                                       const Phase& phase);

}  // namespace calibrato
