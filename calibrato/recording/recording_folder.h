#pragma once

#include <string>

#include "calibrato/recording/recording.h"

namespace calibrato {

/// Opens a folder, its kind recognised from what is in it, in this order:
/// - corners: cam0_corners.csv[.gz], cam1_corners.csv[.gz], .. (docs/formats.md section 3); their
///   resolution from the options, else from `resolution: [width, height]` in cam0_sensor.yaml,
///   cam0/sensor.yaml or sensor.yaml (as EuRoC has them), else from camchain.yaml;
/// - cameras: images in cam0/data/ or cam0/, cam1/data/ or cam1/, ..; `encoding: bayer_rggb8` in
///   cam0/sensor.yaml says that its grey images are mosaics of colours;
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
[[nodiscard]] Recording OpenRecordingFolder(const std::string& path,
                                            const RecordingOptions& options);

/// True where OpenRecordingFolder would find corners, cameras or photos.
[[nodiscard]] bool HoldsCameras(const std::string& folder);

}  // namespace calibrato
