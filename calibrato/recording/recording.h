#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "calibrato/recording/image_reader.h"
#include "calibrato/recording/imu_recording.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// What one camera recorded: images still to be searched for the board, or corners already found.
struct CameraRecording {
  std::string name;  ///< "cam0", the glob that chose its photos, or its topic.
  std::variant<CameraImages, std::vector<BoardView>> data;
  /// Known for corner lists only where a file or the caller says so; images carry their own.
  std::optional<Resolution> resolution;
};

/// A recording, real or simulated, in a folder, a bag or a video: they look alike. Stamps, corners
/// and IMU samples are in memory, images are read when they are asked for.
struct Recording {
  std::string path;
  std::vector<CameraRecording> cameras;  ///< Each with at least one image or view.
  std::vector<ImuRecording> imus;        ///< In order imu0, imu1, ..; empty where there is none.
  std::vector<std::string> warnings;     ///< What was left out of it, and why; one line each.
};

struct RecordingOptions {
  /// One glob a camera. Of a folder of photos: "left[01]*.jpg" or "left/*.jpg"; empty means every
  /// image in the folder, of one camera. Of a bag: its topic, "/cam0/image_raw" or "/left/*".
  std::vector<std::string> image_globs;
  /// Of a bag: one glob an IMU.
  std::vector<std::string> imu_globs;
  /// Of a video without a list of stamps: frames per second [Hz]; else what the file says.
  std::optional<double> frame_rate_hz;
  /// For corner lists without x y z: where the corners are on the board, from its target file.
  std::optional<Eigen::Matrix3Xd> board_points_g;
  std::optional<Resolution> resolution;  ///< Of corner lists; overrides every file.
  bool with_imus = true;                 ///< False leaves the IMUs unread.
  bool with_cameras = true;              ///< False leaves the cameras unread.
  /// A recording of IMUs alone is one too; else it is an error to have no camera.
  bool cameras_may_be_missing = false;
};

/// Opens a recording. What kind it is, its content tells, not its name:
/// - a folder of cameras, corner lists or photos (recording/recording_folder.h);
/// - a ROS 1 bag, an MCAP file, a ROS 2 bag (its folder, or its database alone)
///   (recording/message_recording.h);
/// - a video (recording/video.h).
/// @throws InputError: missing, of no known kind, without cameras (where they are
/// asked for), or what the kinds throw.
[[nodiscard]] Recording OpenRecording(const std::string& path, const RecordingOptions& options);

}  // namespace calibrato
