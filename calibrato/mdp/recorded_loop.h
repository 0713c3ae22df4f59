#pragma once

#include <vector>

#include "calibrato/motion/carrier.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"
#include "calibrato/simulation/fidelity.h"

namespace calibrato {

/// What camera 0 and the IMU recorded during one loop.
struct RecordedLoop {
  std::vector<BoardView> views;      ///< Frames in which the board was found, in order of time.
  int num_frames = 0;                ///< Taken in all.
  bool last_frame_has_board = true;  ///< False also if there was no frame.
  ImuStream imu;                     ///< Empty unless wanted.
};

/// Simulates it at the fidelity asked for; at `rendered` the board is searched in the images by
/// room `detection`.
/// @param rng  Camera and IMU draw from streams of their own, as in SimulateRun; the frames of
///     `fast` without an IMU from this one itself.
/// @throws InputError as SimulateRun: physical without an arm, nothing to render with.
[[nodiscard]] RecordedLoop RecordLoop(const Rig& rig, const TimedMotion& motion, Fidelity fidelity,
                                      Time start, const Rng& rng, bool want_imu);

}  // namespace calibrato
