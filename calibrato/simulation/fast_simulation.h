#pragma once

#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/sensors/measurements.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// What camera 0 recorded while the carrier moved, and what the truth was.
struct SimulatedFrames {
  std::vector<BoardView> views;  ///< Frames in which the board was found, in order of time.
  std::vector<Rigid3> T_c0_g;    ///< True board pose, one a view.
  int num_frames = 0;            ///< Taken in all; the others fall under the next three.
  int num_out_of_image = 0;      ///< Too little of the board inside the image.
  int num_lost_to_blur = 0;      ///< Not detected.
  int num_dropped = 0;           ///< Never arrived.
};

/// Fidelity `fast`: the carrier follows the timed loops exactly; at the camera's rate every corner
/// is projected through the distorted lens and disturbed as `CornerNoise` says; the lens's
/// residual, the stand's motion, a rolling shutter, varying exposures, jitter and drops are those
/// of the rig. Of a checkerboard and a grid of circles the whole board must be inside the image, of
/// an AprilGrid each tag for itself, of a ChArUco board each corner, four corners at least. What
/// the arm's finger hides is not seen.
/// @param start  Camera clock at the motion's first instant; frames are taken at start + k / rate
/// while the motion lasts, its end excluded.
[[nodiscard]] SimulatedFrames SimulateFrames(const Rig& rig, const TimedMotion& motion, Time start,
                                             Rng& rng);
/// The same corners along any path, such as the one that the arm took (fidelity `physical`).
[[nodiscard]] SimulatedFrames SimulateFrames(const Rig& rig, const CarrierPath& path, Time start,
                                             Rng& rng);

/// Pose of the board in camera 0 when the controlled frame is at T_b_e; of a board that stands
/// still.
[[nodiscard]] Rigid3 BoardInCamera(const Rig& rig, const Rigid3& T_b_e);

}  // namespace calibrato
