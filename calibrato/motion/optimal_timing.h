#pragma once

#include <functional>

#include "calibrato/motion/fastest_phase.h"
#include "calibrato/motion/time_law.h"

namespace calibrato {

/// No loop is planned to take less, whatever the carrier could do [s].
inline constexpr double kShortestLoop = 0.5;

/// How long a loop takes from rest to rest at the squared speeds of FastestSquaredSpeeds, where
/// acceleration may jump: no time law within the limits is shorter (but for the grid) [s].
[[nodiscard]] double LeastDuration(const std::function<PhaseLimits(double theta)>& limits_at);

/// The shortest time law that was found for a loop with continuous acceleration:
///
/// 1. the fastest motion along the path (fastest_phase.h) on a grid of 496 phases, its acceleration
///    bounded too, so that the phase takes 0.05 s at least to come up to its mean speed;
/// 2. its phase at equal times at most 10 ms apart (of loops beyond 100 s, a ten thousandth), taken
///    as control points of a cubic B-spline: an average over 40 ms, which makes acceleration
///    continuous and jerk finite;
/// 3. stretched by the factor that `smallest_stretch` asks for: averaging moves acceleration to
///    where the path allows a little less, and jerk is not a limit of step 1.
///
/// If the quintic, as short as the limits allow, is no slower, it is returned: never is the result
/// slower than that.
///
/// @param limits_at  Limits at a phase in [0, 2 pi].
/// @param smallest_stretch  The smallest factor >= 1 for a law to keep all limits.
[[nodiscard]] TimeLaw FastestTimeLaw(const std::function<PhaseLimits(double theta)>& limits_at,
                                     const std::function<double(const TimeLaw&)>& smallest_stretch);

}  // namespace calibrato
