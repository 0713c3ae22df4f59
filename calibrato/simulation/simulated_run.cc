#include "calibrato/simulation/simulated_run.h"

#include <algorithm>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/photo.h"
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

SimulatedRun SimulateRun(
    const Rig& rig, const TimedMotion& motion, Fidelity fidelity, Time start, const Rng& rng,
    const std::function<void(const CarrierPath& path, const SimulatedImage& image)>& on_image) {
  const bool is_arm = motion.motion.carrier == Carrier::kArm;
  if (fidelity == Fidelity::kPhysical && !is_arm) {
    throw InputError({"fidelity physical is that of an arm", "",
                      "the carrier '" + CarrierName(motion.motion.carrier) + "' has no dynamics",
                      "use --carrier arm, or --fidelity fast"});
  }
  SimulatedRun run;
  run.path = PlannedPath(motion);
  if (fidelity != Fidelity::kFast && is_arm) {
    Rng arm_noise = rng.Stream("simulate arm");
    const ArmScene scene(rig);
    const ArmExecution execution = ExecuteOnArm(scene, rig, motion, arm_noise);
    run.tracking = Worst(execution);
    run.path = PathOf(execution, motion.duration_s());
  }
  if (fidelity == Fidelity::kRendered) {
    const auto keep = [&](const SimulatedImage& image) {
      run.images.push_back({image.stamp, EncodePng(image.image)});
      if (on_image) on_image(run.path, image);
    };
    const int num_dropped =
        SimulateImages(rig, run.path, start, rng.Stream("simulate images"), keep);
    run.frames.num_frames = static_cast<int>(run.images.size()) + num_dropped;
    run.frames.num_dropped = num_dropped;
  } else {
    Rng noise = rng.Stream("simulate");
    run.frames = SimulateFrames(rig, run.path, start, noise);
  }
  Rng imu_noise = rng.Stream("simulate imu");
  run.imu = SimulateImu(rig, run.path, start, imu_noise);
  return run;
}

}  // namespace calibrato
