#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

/// What lens, light and sensor do to images: all off by default. The exposure time is the rig's
/// exposure_s. What concerns times (shutter, varying exposure, jitter, drops) holds at every
/// fidelity, the rest at `rendered`.
struct ImageDisturbances {
  double line_delay_s = 0.0;  ///< Rolling shutter: each row is exposed so much later [s] >= 0.
  double read_noise = 0.0;    ///< Standard deviation in the dark [grey levels] >= 0.
  double shot_noise = 0.0;    ///< Variance per grey level [grey levels] >= 0.
  double vignetting = 0.0;    ///< Relative loss of light in the image's corners, 0 to 1.
  /// Relative change of light from the image's middle to its right and to its lower edge.
  Eigen::Vector2d lighting_gradient = Eigen::Vector2d::Zero();
  double defocus_px = 0.0;      ///< Standard deviation of the lens's blur [px] >= 0.
  double stamp_jitter_s = 0.0;  ///< Standard deviation of the stamps about the exposures [s] >= 0.
  double drop_probability = 0.0;  ///< Of a frame that never arrives, 0 to 1.
  /// The camera adapts its exposure to light that comes and goes, and keeps the images as bright as
  /// they were: frames are exposed for exposure_s (1 + this sin(2 pi t / 7 s)), 0 to 1. An exposure
  /// begins on the trigger, and its stamp is the trigger's plus half of exposure_s, as if nothing
  /// varied: the true middle is later by up to half of this share of exposure_s.
  double exposure_variation = 0.0;
};

/// RIG.yaml's optional key `images`: {line_delay_s, read_noise, shot_noise, vignetting,
/// lighting_gradient: [2], defocus_px, stamp_jitter_s, drop_probability, exposure_variation}, each
/// optional.
/// @throws InputError with line and key. Unknown keys are appended to warnings (may be null).
[[nodiscard]] ImageDisturbances ImageDisturbancesFromValue(const Value& value,
                                                           std::vector<std::string>* warnings);
[[nodiscard]] Value ToValue(const ImageDisturbances& disturbances);

}  // namespace calibrato
