#pragma once

#include <string>

#include "calibrato/base/value.h"
#include "calibrato/motion/motion.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// training.jsonl of the folder as one array; a last line that is only half written is left out.
[[nodiscard]] Value TrainingLines(const std::string& folder);

/// The motion as the report draws it (report/report.h): the camera's way loop by loop, where it
/// looks now and then, and the board. Null for a motion without loops, or one that the carrier
/// can't make with this rig at any scale.
[[nodiscard]] Value MotionDrawing(const Motion& motion, const Rig& rig);

}  // namespace calibrato
