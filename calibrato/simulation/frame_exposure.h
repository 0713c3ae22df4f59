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

}  // namespace calibrato
