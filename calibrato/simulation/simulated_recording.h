#pragma once

#include <map>
#include <string>

#include "calibrato/motion/carrier.h"
#include "calibrato/simulation/simulated_run.h"

namespace calibrato {

/// The files of a simulated recording by name, ready to be written: a folder of corners and IMU
/// samples that opens like any other, and the truth beside it (docs/formats.md section 3). Poses
/// are stamped by the IMU's clock.
/// @param start  The camera's clock when the motion begins.
[[nodiscard]] std::map<std::string, std::string> SimulatedRecordingFiles(const Rig& rig,
                                                                         const TimedMotion& motion,
                                                                         Time start,
                                                                         const SimulatedRun& run);

}  // namespace calibrato
