#pragma once

#include <numbers>

namespace calibrato {

/// A loop has 62 way-points after its start, as in the original implementation; the last one closes
/// it.
inline constexpr int kNumWayPoints = 62;

/// theta = 2 pi way_point / 62 [rad]. @param way_point  0 (the start) to 62.
[[nodiscard]] constexpr double WayPointPhase(int way_point) {
  return 2.0 * std::numbers::pi * way_point / kNumWayPoints;
}

}  // namespace calibrato
