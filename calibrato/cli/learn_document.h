#pragma once

#include <string>

#include "calibrato/base/value.h"
#include "calibrato/motion/motion.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// training.jsonl of the folder as one array; a last line that is only half written is left out.
[[nodiscard]] Value TrainingLines(const std::string& folder);

/// The motion as the report draws and plays it (report/report.h), with the board. Null for a motion
/// without loops, or one that the carrier can't make with this rig at any scale.
[[nodiscard]] Value LearnedMotionDrawing(const Motion& motion, const Rig& rig);

}  // namespace calibrato
