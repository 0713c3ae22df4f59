#include "calibrato/motion/scale_to_fit.h"

#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

Motion Scaled(const Motion& motion, double factor) {
  Motion scaled = motion;
  for (Loop& loop : scaled.loops) loop.coefficients *= factor;
  return scaled;
}

}  // namespace

TimedMotion LargestThatFits(const Motion& motion, const std::string& who,
                            const MotionPlanner& plan) {
  std::variant<TimedMotion, Refusal> planned = plan(motion);
  if (auto* whole = std::get_if<TimedMotion>(&planned)) return std::move(*whole);

  planned = plan(Scaled(motion, 0.0));
  if (const auto* refusal = std::get_if<Refusal>(&planned)) {
    throw InputError({"the motion does not fit " + who, "",
                      "not even its base pose does: " + refusal->Describe(),
                      "choose another base_pose"});
  }
  // Beyond the tolerance only while nothing but zero is known to fit.
  constexpr double kTolerance = 1e-3;
  constexpr double kSmallestFactor = 1e-9;
  double fits = 0.0;
  double too_large = 1.0;
  TimedMotion best;
  while (too_large - fits > kTolerance || fits == 0.0) {
    const double factor = 0.5 * (fits + too_large);
    if (factor < kSmallestFactor) {
      throw InputError({"the motion does not fit " + who, "", "its base pose lies on a limit of it",
                        "choose another base_pose"});
    }
    planned = plan(Scaled(motion, factor));
    if (auto* timed = std::get_if<TimedMotion>(&planned)) {
      best = std::move(*timed);
      best.scale = fits = factor;
    } else {
      too_large = factor;
    }
  }
  return best;
}

}  // namespace calibrato
