#pragma once

#include <map>
#include <string>

#include "calibrato/motion/carrier.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/imu_simulation.h"

namespace calibrato {

/// The files of a simulated recording by name, ready to be written: a folder of corners and IMU
/// samples that opens like any other, and the truth beside it (docs/formats.md section 3). Poses
/// are stamped by the IMU's clock.
/// @param path  Where the carrier was: PlannedPath(motion), or what the arm made of it.
///
///     cam0_corners.csv   sensor.yaml     what the camera saw
///     imu0.csv           imu.yaml        what the IMU felt, and its noise
///     target.yaml        rig.yaml        what was seen, and with what
///     motion.yaml                        the motion with its timed path (joints too, on the arm)
///     truth.yaml         truth_poses.csv camera, T_cam_imu, biases, gravity; T_g_i at 200 Hz
[[nodiscard]] std::map<std::string, std::string> SimulatedRecordingFiles(
    const Rig& rig, const TimedMotion& motion, const CarrierPath& path, Time start,
    const SimulatedFrames& frames, const SimulatedImu& imu);

}  // namespace calibrato
