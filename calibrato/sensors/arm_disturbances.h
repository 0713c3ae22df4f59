#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

/// What a real arm does to a motion, from fidelity `physical` on: all off by default.
struct ArmDisturbances {
  /// The links swing on their gears at this frequency, each joint by itself, excited by jerk [Hz];
  /// 0: stiff gears. Real arms have 10 to 30 Hz.
  double mode_hz = 0.0;
  double mode_damping = 0.05;  ///< As a share of critical damping, in (0, 1).
  /// Standard deviation of each joint's torque per joint speed, white up to half the simulation's
  /// rate [N m per rad/s]: what gears and motors do to a moving arm.
  double torque_ripple = 0.0;
};

/// RIG.yaml's optional key `arm.disturbances`: {mode_hz, mode_damping, torque_ripple_nm_s_rad},
/// each optional. @throws InputError with line and key. Unknown keys are appended to warnings (may
/// be null).
[[nodiscard]] ArmDisturbances ArmDisturbancesFromValue(const Value& value,
                                                       std::vector<std::string>* warnings);
[[nodiscard]] Value ToValue(const ArmDisturbances& disturbances);

}  // namespace calibrato
