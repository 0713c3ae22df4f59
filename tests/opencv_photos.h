#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibrato/detection/detect.h"
#include "calibrato/recording/recording.h"

namespace calibrato {

/// The 13 stereo pairs of Debian's package opencv-doc: a board of 9 x 6 inner corners and 25 mm.
inline constexpr const char* kOpenCvPhotos = "/usr/share/doc/opencv-doc/examples/data";
inline constexpr const char* kNoOpenCvPhotos =
    "the photos of opencv-doc are not installed; tools/install_dependencies does";

inline bool HaveOpenCvPhotos() {
  return std::filesystem::exists(std::string(kOpenCvPhotos) + "/left01.jpg");
}

inline Detections DetectInPhotos(const std::string& folder, const std::string& glob,
                                 const Board& board, std::vector<std::string>* names = nullptr) {
  RecordingOptions options;
  if (!glob.empty()) options.image_globs = {glob};
  const Recording recording = OpenRecording(folder, options);
  const auto& images = std::get<CameraImages>(recording.cameras.at(0).data);
  ImageSource source;
  for (const RecordedImage& image : images.list) source.names.push_back(image.name);
  source.load = [&](size_t k) { return GreyOf(images.reader->Read(k)); };
  if (names != nullptr) *names = source.names;
  return DetectBoards(source, board);
}

}  // namespace calibrato
