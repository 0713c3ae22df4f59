#pragma once

#include <variant>

#include "calibrato/motion/carrier.h"

namespace calibrato {

/// PlanMotion for Carrier::kFree. Reach, height and the board's view are checked at every
/// way-point; speeds and accelerations, as Euclidean norms, stretch each loop's time (stretch.h)
/// or, under optimal timing, are what it is made from.
[[nodiscard]] std::variant<TimedMotion, Refusal> PlanOnFreeCarrier(const Motion& motion,
                                                                   const Rig& rig);

}  // namespace calibrato
