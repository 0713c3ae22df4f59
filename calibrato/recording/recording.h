#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "calibrato/recording/imu_recording.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// One image on disk, not yet read.
struct ImageFile {
  std::string name;  ///< File name without its folder.
  std::string path;
  Time stamp;  ///< 0 for photos without stamps.
};

/// What one camera recorded: images still to be searched for the board, or corners already found.
struct CameraRecording {
  std::string name;  ///< "cam0", or the glob that chose its photos.
  std::variant<std::vector<ImageFile>, std::vector<BoardView>> data;
  /// Known for corner lists only where a file or the caller says so; images carry their own.
  std::optional<Resolution> resolution;
};

/// A recording, real or simulated: they look alike.
struct Recording {
  std::string path;
  std::vector<CameraRecording> cameras;  ///< At least one, each with at least one image or view.
  std::vector<ImuRecording> imus;        ///< In order imu0, imu1, ..; empty where there is none.
};

struct RecordingOptions {
  /// For folders of photos: one glob a camera, "left[01]*.jpg" or "left/*.jpg"; empty means every
  /// image in the folder, of one camera.
  std::vector<std::string> image_globs;
  /// For corner lists without x y z: where the corners are on the board, from its target file.
  std::optional<Eigen::Matrix3Xd> board_points_g;
  std::optional<Resolution> resolution;  ///< Of corner lists; overrides every file.
  bool with_imus = true;                 ///< False leaves the IMUs' files unopened.
};

/// Opens a folder, its kind recognised from what is in it, in this order:
/// - corners: cam0_corners.csv[.gz], cam1_corners.csv[.gz], .. (docs/formats.md section 3); their
///   resolution from the options, else from `resolution: [width, height]` in cam0_sensor.yaml,
///   cam0/sensor.yaml or sensor.yaml (as EuRoC has them), else from camchain.yaml;
/// - cameras: images in cam0/data/ or cam0/, cam1/data/ or cam1/, ..;
/// - photos: images directly in the folder, or those that the globs choose.
/// EuRoC's folder mav0/ is entered where the folder itself has no cameras. IMUs stand beside
/// corners or cameras: recording/imu_recording.h. Images are files that end in png, jpg, jpeg, bmp,
/// tif, tiff or pgm. They have stamps where every name is a number of ten digits or more, the stamp
/// [ns], and come in its order; else in that of their names, and number k of one camera was taken
/// together with number k of the next.
/// @throws InputError: folder missing or without a recording (says what was looked for), globs for
/// another kind of folder, a glob that matches no image, a camera missing in between, images of
/// cam0/ of which only some have stamps, two images of one stamp, unequal numbers of photos without
/// stamps, a listed image that is not there; and all that ReadCornerList, ReadImageList and
/// OpenImuRecordings throw.
[[nodiscard]] Recording OpenRecording(const std::string& path, const RecordingOptions& options);

}  // namespace calibrato
