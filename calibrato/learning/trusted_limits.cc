#include "calibrato/learning/trusted_limits.h"

#include <cmath>
#include <utility>

namespace calibrato {
namespace {

constexpr double kLeastSpeed = 0.25;
constexpr double kLeastAcceleration = 0.1;
constexpr double kLeastAmplitude = 0.25;
constexpr double kMostMarginPx = 40.0;

}  // namespace

TrustedLimits LimitsOf(const Trust& trust) {
  const Trust distrust = Trust::Ones() - trust;
  return {std::pow(kLeastSpeed, distrust(0)), std::pow(kLeastAcceleration, distrust(1)),
          std::pow(kLeastAmplitude, distrust(2)), kMostMarginPx * distrust(3)};
}

MotionDesignProblem Within(MotionDesignProblem problem, const TrustedLimits& limits) {
  problem.limits.speed *= limits.speed;
  problem.limits.angular_speed *= limits.speed;
  problem.limits.acceleration *= limits.acceleration;
  problem.limits.angular_acceleration *= limits.acceleration;
  problem.coefficient_limit *= limits.amplitude;
  problem.extra_margin_px += limits.extra_margin_px;
  return problem;
}

Value ToValue(const TrustedLimits& limits) {
  return Value::Object()
      .Set("speed_share", limits.speed)
      .Set("acceleration_share", limits.acceleration)
      .Set("amplitude_share", limits.amplitude)
      .Set("extra_margin_px", limits.extra_margin_px);
}

}  // namespace calibrato
