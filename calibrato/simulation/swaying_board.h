#pragma once

#include "calibrato/motion/carrier.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// Where the board stands at one instant: T_w_g, moved along each of the board's axes by
///
///     sqrt(2/3) stand_motion_m sin(2 pi t / T),   T = 11, 17 and 23 s along x, y and z
///
/// so that it is at its place when the motion begins, and the root mean square of how far it is
/// from there is stand_motion_m over long times. It does not turn.
/// @param t_s  Since the motion began [s].
[[nodiscard]] Rigid3 BoardInWorld(const Rig& rig, double t_s);

/// Pose of the board in camera 0 at an instant of a path, wherever carrier and board are then.
[[nodiscard]] Rigid3 BoardInCamera(const Rig& rig, const CarrierPath& path, double t_s);

}  // namespace calibrato
