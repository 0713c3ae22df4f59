#pragma once

#include <variant>

#include "calibrato/motion/carrier.h"

namespace calibrato {

/// PlanMotion for Carrier::kFree. Reach, height and the board's view are checked at every
/// way-point; speeds and accelerations, as Euclidean norms at 500 instants of each loop, stretch
/// its time.
[[nodiscard]] std::variant<TimedMotion, Refusal> PlanOnFreeCarrier(const Motion& motion,
                                                                   const Rig& rig);

}  // namespace calibrato
