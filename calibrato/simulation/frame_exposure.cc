#include "calibrato/simulation/frame_exposure.h"

#include <cmath>
#include <numbers>

namespace calibrato {

FrameExposure ExposureOfFrame(const Rig& rig, double stamp_s) {
  constexpr double kPeriod = 7.0;  // of the light [s]
  const double brightness = std::sin(2.0 * std::numbers::pi * stamp_s / kPeriod);
  const double longer_s = rig.exposure_s * rig.image_disturbances.exposure_variation * brightness;
  return {stamp_s + 0.5 * longer_s, rig.exposure_s + longer_s};
}

}  // namespace calibrato
