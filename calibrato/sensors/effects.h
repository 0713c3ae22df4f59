#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibrato/sensors/rig.h"

namespace calibrato {

/// Something that real arms, cameras and IMUs do and the paper's simulator does not: one switch,
/// with the size that it has on ordinary hardware. A rig file gives each another size by its key
/// (docs/simulation.md has the table).
struct Effect {
  std::string_view name;  ///< As on the command line: "stand-motion".
  std::string_view key;   ///< Of the rig file: "stand_motion_m".
  std::string_view size;  ///< For people: "0.2 mm".
  void (*switch_on)(Rig* rig);
  /// Whether it belongs to every real rig; a rolling shutter is another camera.
  bool is_everywhere = true;
};

/// All there are, in the order of light, image, time, arm, IMU.
[[nodiscard]] const std::vector<Effect>& Effects();

/// Gives the rig the named effects at their ordinary size, whatever size it had of them.
/// @param names  Effects separated by commas, or "all": every one that is everywhere.
/// @throws InputError for a name that is not there; the nearest is named.
void SwitchOnEffects(const std::string& names, Rig* rig);

}  // namespace calibrato
