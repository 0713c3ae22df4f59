#pragma once

#include "calibrato/sensors/rig.h"

namespace calibrato {

/// When one frame was exposed, in seconds since the motion began.
struct FrameExposure {
  double middle_s = 0.0;  ///< Of the exposure of the first row.
  double length_s = 0.0;  ///< >= 0
};

/// Of the frame that is stamped `stamp_s` after the motion's begin, jitter aside: the same instant,
/// unless the exposure varies (ImageDisturbances::exposure_variation).
[[nodiscard]] FrameExposure ExposureOfFrame(const Rig& rig, double stamp_s);

/// How much later than that it is stamped [s], for one draw of the standard normal distribution:
/// stamp_jitter_s times it, cut off at 0.45 of the time between two frames. So stamps stay in the
/// order of their frames, whatever the jitter.
[[nodiscard]] double StampJitter(const Rig& rig, double normal);

}  // namespace calibrato
