#pragma once

#include <Eigen/Core>

#include "calibrato/base/value.h"
#include "calibrato/mdp/design_problem.h"

namespace calibrato {

/// How far expected information is trusted. Its model knows nothing of blur, vibration, delays or
/// lenses that fit no model; all of them grow towards the limits of carrier and image. So what
/// there is to learn about a design is how close to those limits it may go: four numbers, each in
/// [0, 1], where 1 is the limit itself.
using Trust = Eigen::Vector4d;

/// What a trust means.
struct TrustedLimits {
  double speed = 1.0;          ///< Share of the carrier's speeds: 1/4 to 1, geometrically.
  double acceleration = 1.0;   ///< Share of the carrier's accelerations: 1/10 to 1, likewise.
  double amplitude = 1.0;      ///< Share of the coefficients' limit: 1/4 to 1, likewise.
  double extra_margin_px = 0;  ///< Inside the border: 40 to 0 px.
};

[[nodiscard]] TrustedLimits LimitsOf(const Trust& trust);
/// The problem, its limits drawn in.
[[nodiscard]] MotionDesignProblem Within(MotionDesignProblem problem, const TrustedLimits& limits);
[[nodiscard]] Value ToValue(const TrustedLimits& limits);

}  // namespace calibrato
