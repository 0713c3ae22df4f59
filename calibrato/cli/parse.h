#pragma once

#include <string>
#include <vector>

#include "calibrato/motion/motion.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// "640x480". @throws InputError
[[nodiscard]] Resolution ParseResolution(const std::string& text);

/// MOTION.yaml and RIG.yaml from their files; warnings go to stderr. @throws InputError
[[nodiscard]] Motion ReadMotion(const std::string& path);
[[nodiscard]] Rig ReadRig(const std::string& path);

/// "warning: ..." on stderr, a line each.
void PrintWarnings(const std::vector<std::string>& warnings);

}  // namespace calibrato
