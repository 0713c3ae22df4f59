#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/diagnosis/finding.h"
#include "calibrato/recording/imu_recording.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// One camera of a recording, as far as it is known before a solve.
struct CheckedCamera {
  std::string name;                  ///< "cam0"
  std::vector<BoardView> views;      ///< In order of time.
  std::optional<CameraModel> model;  ///< Without it, its motion is not compared with the IMUs'.
};

/// One IMU of a recording, as it was read.
struct CheckedImu {
  ImuRecording recording;
  std::optional<ImuNoise> noise;  ///< Without it, its rate is not compared with the YAML's.
};

/// The plain check of cameras and IMUs before they are solved together, of each alone and of each
/// IMU against each camera. Findings begin with the name of what they are about.
///
/// - fail: the solve can't be right. Fewer than ten views, views without stamps, or hardly any two
///   within half a second; a sensor without samples; clocks whose times have no part in common, or
///   that are more than a second apart; gyroscope in deg/s; accelerometer in g, without gravity or
///   of another size; columns of the two swapped; a rig that did not move, or did not turn; a pause
///   of all of an IMU for more than ten seconds, or a clock that was set.
/// - inconclusive: the solve leaves something open. A rig that turned about one axis only.
/// - warn: the solve runs, on less or on worse. Samples that are not finite, stamps out of order or
///   twice, gaps, saturation (`Mended` deals with them); an axis that never changes; a rate more
///   than 10 % off the YAML's; a camera seen in part only by the IMU; clocks more than 0.1 s apart;
///   speeds of camera and gyroscope that do not fit together.
///
/// Units show in sizes: the median specific force of a rig in hands is within 20 % of gravity, and
/// the gyroscope turns as fast as the board does in the camera, in any frame.
/// @param gravity  Its size where the recording was made [m/s^2].
[[nodiscard]] std::vector<Finding> CheckStreams(const std::vector<CheckedCamera>& cameras,
                                                const std::vector<CheckedImu>& imus,
                                                double gravity = kStandardGravity);

}  // namespace calibrato
