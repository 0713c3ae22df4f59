#pragma once

#include <optional>

#include "calibrato/motion/carrier.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/fidelity.h"
#include "calibrato/simulation/imu_simulation.h"

namespace calibrato {

/// How well the arm followed its plan.
struct Tracking {
  double max_position_error_m = 0.0;
  double max_rotation_error_rad = 0.0;
  double max_torque_share = 0.0;  ///< Of the motor's limit, over all joints.
};

/// A motion, simulated: where the carrier was, and what the sensors made of it.
struct SimulatedRun {
  CarrierPath path;
  SimulatedFrames frames;
  SimulatedImu imu;
  std::optional<Tracking> tracking;  ///< From fidelity `physical` on.
};

/// Corners, IMU samples and arm draw from streams of their own, so that one does not depend on the
/// others: those of `rng` for "simulate", "simulate imu" and "simulate arm".
/// @param start  The camera's clock when the motion begins.
/// @throws InputError: no dynamics without an arm; an arm that does not follow.
[[nodiscard]] SimulatedRun SimulateRun(const Rig& rig, const TimedMotion& motion, Fidelity fidelity,
                                       Time start, const Rng& rng);

}  // namespace calibrato
