#pragma once

#include "calibrato/motion/motion.h"

namespace calibrato {

/// What people who calibrate often do by hand, and what the makers of Kalibr advise: three sweeps
/// along each axis, three about each axis, and a figure eight in all six degrees of freedom, the
/// board in view throughout and as fast as the carrier can. The same for both tasks.
///
/// A sweep goes to both sides and back. The three of an axis are two loops, of one sweep and of
/// two; with the figure eight that makes 13 loops. Each wishes for half a second only, so that the
/// carrier's limits set its duration.
[[nodiscard]] Motion ExpertMotion();

}  // namespace calibrato
