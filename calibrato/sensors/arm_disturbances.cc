#include "calibrato/sensors/arm_disturbances.h"

namespace calibrato {

ArmDisturbances ArmDisturbancesFromValue(const Value& value, std::vector<std::string>* warnings) {
  const std::vector<std::string> unknown =
      value.UnknownKeys({"mode_hz", "mode_damping", "torque_ripple_nm_s_rad"});
  if (warnings != nullptr) warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  ArmDisturbances arm;
  if (const Value* x = value.Find("mode_hz")) {
    arm.mode_hz = x->AsNonNegative();
    if (!(arm.mode_hz <= 100.0) || (arm.mode_hz > 0.0 && arm.mode_hz < 1.0)) {
      x->Fail("bad frequency of the arm",
              "0 is none; the simulation's steps of 1 ms follow 1 to 100 Hz", "write 10 to 30");
    }
  }
  if (const Value* x = value.Find("mode_damping")) {
    arm.mode_damping = x->AsPositive();
    if (!(arm.mode_damping < 1.0)) {
      x->Fail("bad damping of the arm", "it must be below 1, critical damping", "write 0.05");
    }
  }
  if (const Value* x = value.Find("torque_ripple_nm_s_rad")) {
    arm.torque_ripple = x->AsNonNegative();
  }
  return arm;
}

Value ToValue(const ArmDisturbances& disturbances) {
  Value value = Value::Object();
  value.Set("mode_hz", disturbances.mode_hz)
      .Set("mode_damping", disturbances.mode_damping)
      .Set("torque_ripple_nm_s_rad", disturbances.torque_ripple);
  return value;
}

}  // namespace calibrato
