#include "calibrato/motion/time_law.h"

#include <algorithm>
#include <cassert>
#include <numbers>

namespace calibrato {

Phase QuinticPhaseAt(double t_s, double duration_s) {
  assert(duration_s > 0.0);
  const double s = std::clamp(t_s / duration_s, 0.0, 1.0);
  const bool is_moving = s > 0.0 && s < 1.0;
  const double scale = 2.0 * std::numbers::pi;
  return {
      .theta = scale * s * s * s * (10.0 + s * (6.0 * s - 15.0)),
      .first = scale * 30.0 * s * s * (1.0 - s) * (1.0 - s) / duration_s,
      .second = scale * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (duration_s * duration_s),
      .third = is_moving ? scale * 60.0 * (1.0 + 6.0 * s * (s - 1.0)) /
                               (duration_s * duration_s * duration_s)
                         : 0.0,
  };
}

}  // namespace calibrato
