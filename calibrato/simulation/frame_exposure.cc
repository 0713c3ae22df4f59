#include "calibrato/simulation/frame_exposure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calibrato {

FrameExposure ExposureOfFrame(const Rig& rig, double stamp_s) {
  constexpr double kPeriod = 7.0;  // of the light [s]
  const double brightness = std::sin(2.0 * std::numbers::pi * stamp_s / kPeriod);
  const double longer_s = rig.exposure_s * rig.image_disturbances.exposure_variation * brightness;
  return {stamp_s + 0.5 * longer_s, rig.exposure_s + longer_s};
}

double StampJitter(const Rig& rig, double normal) {
  const double most_s = 0.45 / rig.camera_rate_hz;
  return std::clamp(rig.image_disturbances.stamp_jitter_s * normal, -most_s, most_s);
}

}  // namespace calibrato
