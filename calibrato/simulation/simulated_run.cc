#include "calibrato/simulation/simulated_run.h"

#include <algorithm>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/simulation/arm_execution.h"

namespace calibrato {
namespace {

Tracking Worst(const ArmExecution& execution) {
  Tracking worst;
  for (const Eigen::Vector2d& error : execution.tracking) {
    worst.max_position_error_m = std::max(worst.max_position_error_m, error[0]);
    worst.max_rotation_error_rad = std::max(worst.max_rotation_error_rad, error[1]);
  }
  for (const JointVector& torque : execution.torque) {
    worst.max_torque_share = std::max(worst.max_torque_share,
                                      torque.cwiseAbs().cwiseQuotient(Limits().torque).maxCoeff());
  }
  return worst;
}

}  // namespace

SimulatedRun SimulateRun(const Rig& rig, const TimedMotion& motion, Fidelity fidelity, Time start,
                         const Rng& rng) {
  CarrierPath path = PlannedPath(motion);
  std::optional<Tracking> tracking;
  if (fidelity == Fidelity::kPhysical) {
    if (motion.motion.carrier != Carrier::kArm) {
      throw InputError({"fidelity physical is that of an arm", "",
                        "the carrier '" + CarrierName(motion.motion.carrier) + "' has no dynamics",
                        "use --carrier arm, or --fidelity fast"});
    }
    Rng arm_noise = rng.Stream("simulate arm");
    const ArmScene scene(rig);
    const ArmExecution execution = ExecuteOnArm(scene, rig, motion, arm_noise);
    tracking = Worst(execution);
    path = PathOf(execution, motion.duration_s());
  }
  Rng noise = rng.Stream("simulate");
  SimulatedFrames frames = SimulateFrames(rig, path, start, noise);
  Rng imu_noise = rng.Stream("simulate imu");
  SimulatedImu imu = SimulateImu(rig, path, start, imu_noise);
  return {std::move(path), std::move(frames), std::move(imu), tracking};
}

}  // namespace calibrato
