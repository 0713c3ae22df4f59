#pragma once

#include <string>
#include <vector>

#include "calibrato/recording/image_reader.h"
#include "calibrato/recording/recording.h"

namespace calibrato {

/// The frames of a video as the images of a camera. Their stamps are those of the list beside it
/// (clip.csv for clip.mp4: one row a frame, the stamp [ns] in the first column), else they follow
/// each other at a constant rate from 0 on: the options', else the file's own, with a warning. The
/// orientation that phones write is ignored, since calibration is about the sensor's own pixels.
///
/// Frames are decoded from the beginning on, one after the other: the number of a frame that a
/// player jumps to is a guess.
/// @throws InputError: not a video that FFmpeg decodes, no frames, more than kMaxImagePixels, a
/// list of another length, stamps that do not ascend, a rate that is not above 0.
[[nodiscard]] CameraImages OpenVideo(const std::string& path, const RecordingOptions& options,
                                     std::vector<std::string>* warnings);

/// The videos cam0, cam1, .. of a folder (cam0.mp4, cam1.avi, whatever their ending), by content.
/// @throws InputError if one is missing in between, or two are of one camera.
[[nodiscard]] std::vector<std::string> VideosOfFolder(const std::string& folder);

}  // namespace calibrato
