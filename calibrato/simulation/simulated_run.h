#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/motion/carrier.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/fidelity.h"
#include "calibrato/simulation/imu_simulation.h"
#include "calibrato/simulation/rendered_camera.h"

namespace calibrato {

/// How well the arm followed its plan.
struct Tracking {
  double max_position_error_m = 0.0;
  double max_rotation_error_rad = 0.0;
  double max_torque_share = 0.0;  ///< Of the motor's limit, over all joints.
};

/// An image as its file.
struct StampedPng {
  Time stamp;
  std::string png;
};

/// A motion, simulated: where the carrier was, and what the sensors made of it.
struct SimulatedRun {
  CarrierPath path;
  SimulatedFrames frames;  ///< Without views at fidelity `rendered`.
  SimulatedImu imu;
  std::optional<Tracking> tracking;  ///< Of the arm, from fidelity `physical` on.
  std::vector<StampedPng> images;    ///< Fidelity `rendered` alone.
};

/// On the arm, fidelities `physical` and `rendered` follow its dynamics; a free carrier is rendered
/// on its plan.
///
/// Corners, images, IMU samples and arm draw from streams of their own, so that one does not depend
/// on the others: those of `rng` for "simulate", "simulate images", "simulate imu", "simulate arm".
/// Runs may go on side by side on threads of their own, at every fidelity; which ones do changes no
/// byte.
/// @param start  The camera's clock when the motion begins.
/// @param on_image  Called with each image of fidelity `rendered` when it is taken; may be empty.
/// @throws InputError: no dynamics without an arm; an arm that does not follow; nothing to render
/// with (HeadlessGl).
[[nodiscard]] SimulatedRun SimulateRun(
    const Rig& rig, const TimedMotion& motion, Fidelity fidelity, Time start, const Rng& rng,
    const std::function<void(const CarrierPath& path, const SimulatedImage& image)>& on_image = {});

}  // namespace calibrato
