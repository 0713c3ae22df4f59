#pragma once

#include <string>

namespace calibrato {

/// How much of a recording is simulated.
enum class Fidelity {
  kFast,      ///< The carrier follows the plan; corners and IMU samples come from formulas.
  kPhysical,  ///< The arm's dynamics move camera and IMU; corners as in `fast`, no images.
  kRendered,  ///< ... and the camera takes images.
};
[[nodiscard]] std::string FidelityName(Fidelity fidelity);  ///< "fast", "physical", "rendered"
[[nodiscard]] Fidelity FidelityFromName(const std::string& name);  ///< @throws InputError

}  // namespace calibrato
