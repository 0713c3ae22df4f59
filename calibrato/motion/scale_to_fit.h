#pragma once

#include <functional>
#include <string>
#include <variant>

#include "calibrato/motion/carrier.h"

namespace calibrato {

/// A motion as something makes it, or why it can't.
using MotionPlanner = std::function<std::variant<TimedMotion, Refusal>(const Motion& motion)>;

/// With all coefficients multiplied by the largest factor in (0, 1] that `plan` accepts (to 1e-3),
/// one for the whole motion.
/// @param who  For errors: "the free carrier", "the arm UR5e".
/// @throws InputError if not even the base pose fits.
[[nodiscard]] TimedMotion LargestThatFits(const Motion& motion, const std::string& who,
                                          const MotionPlanner& plan);

}  // namespace calibrato
