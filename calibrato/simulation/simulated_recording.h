#pragma once

#include <map>
#include <string>

#include "calibrato/motion/carrier.h"
#include "calibrato/simulation/fast_simulation.h"

namespace calibrato {

/// The files of a simulated recording by name, ready to be written: a folder of corners that opens
/// like any other, and the truth beside it (docs/formats.md section 3).
///
///     cam0_corners.csv   sensor.yaml    what the camera saw
///     target.yaml        rig.yaml       what it saw it with
///     motion.yaml                       the motion with its timed path (joints too, on the arm)
///     truth.yaml         truth_poses.csv    camera, T_cam_imu, gravity; T_g_i at 200 Hz on the
///     IMU's clock
[[nodiscard]] std::map<std::string, std::string> SimulatedRecordingFiles(
    const Rig& rig, const TimedMotion& motion, Time start, const SimulatedFrames& frames);

}  // namespace calibrato
