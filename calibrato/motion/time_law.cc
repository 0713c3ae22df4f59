#include "calibrato/motion/time_law.h"

#include <algorithm>
#include <cassert>
#include <numbers>

namespace calibrato {
namespace {

Phase SplinePhaseAt(const std::vector<double>& control_points, double t_s, double duration_s) {
  assert(control_points.size() > 3 && duration_s > 0.0);
  const size_t num_segments = control_points.size() - 3;
  const double per_second = static_cast<double>(num_segments) / duration_s;
  const double position =
      std::clamp(t_s / duration_s, 0.0, 1.0) * static_cast<double>(num_segments);
  const size_t segment = std::min(static_cast<size_t>(position), num_segments - 1);
  const double u = position - static_cast<double>(segment);
  const double* c = &control_points[segment];
  const double w = 1.0 - u;
  const bool is_moving = t_s > 0.0 && t_s < duration_s;
  const double third = c[3] - 3.0 * c[2] + 3.0 * c[1] - c[0];
  return {
      .theta = (w * w * w * c[0] + (4.0 + 3.0 * u * u * (u - 2.0)) * c[1] +
                (4.0 + 3.0 * w * w * (w - 2.0)) * c[2] + u * u * u * c[3]) /
               6.0,
      .first =
          0.5 * per_second *
          (w * w * (c[1] - c[0]) + (1.0 + 2.0 * u * w) * (c[2] - c[1]) + u * u * (c[3] - c[2])),
      .second = per_second * per_second *
                (w * (c[2] - 2.0 * c[1] + c[0]) + u * (c[3] - 2.0 * c[2] + c[1])),
      .third = is_moving ? per_second * per_second * per_second * third : 0.0,
  };
}

}  // namespace

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

Phase PhaseAt(const std::vector<double>& control_points, double t_s, double duration_s) {
  return control_points.empty() ? QuinticPhaseAt(t_s, duration_s)
                                : SplinePhaseAt(control_points, t_s, duration_s);
}

Phase PhaseAt(const TimeLaw& law, double t_s) {
  return PhaseAt(law.control_points, t_s, law.duration_s);
}

double TimeOfPhase(const TimeLaw& law, double theta) {
  double before = 0.0;
  double after = 1.0;
  constexpr int kNumHalvings = 60;
  for (int k = 0; k < kNumHalvings; ++k) {
    const double middle = 0.5 * (before + after);
    (PhaseAt(law.control_points, middle, 1.0).theta < theta ? before : after) = middle;
  }
  return after * law.duration_s;
}

}  // namespace calibrato
