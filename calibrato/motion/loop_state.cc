#include "calibrato/motion/loop_state.h"

#include "calibrato/geometry/rpy.h"

namespace calibrato {

CarrierState LoopStateAt(const BasePose& base, const LoopCoefficients& coefficients,
                         const Phase& phase) {
  const LoopOffset offset = LoopOffsetAt(coefficients, phase.theta);
  const PoseVector rates = offset.first * phase.first;
  const PoseVector accelerations =
      offset.second * (phase.first * phase.first) + offset.first * phase.second;
  const Eigen::Vector3d rpy = base.rpy_rad + offset.value.tail<3>();
  return {
      .T_b_e = {RotationFromRpy(rpy), base.xyz_m + offset.value.head<3>()},
      .velocity_b = rates.head<3>(),
      .acceleration_b = accelerations.head<3>(),
      .angular_velocity_b = AngularVelocityFromRpyRates(rpy) * rates.tail<3>(),
      .angular_acceleration_b =
          AngularAccelerationFromRpy(rpy, rates.tail<3>(), accelerations.tail<3>()),
  };
}

}  // namespace calibrato
