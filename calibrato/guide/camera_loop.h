#pragma once

#include "calibrato/geometry/rigid3.h"
#include "calibrato/motion/looped_trajectory.h"

namespace calibrato {

/// A loop of a motion that was made for a carrier, as its camera goes it.
struct CameraLoop {
  BasePose base;
  LoopCoefficients coefficients = LoopCoefficients::Zero();
  Rigid3 T_e_c;  ///< Where the camera sits on the frame that was to go the loop.
};

/// T_c0_c: the camera at a phase theta [rad], seen from the camera where the loop begins and ends.
[[nodiscard]] Rigid3 PoseAt(const CameraLoop& loop, double theta);

}  // namespace calibrato
