#include "calibrato/recording/recording.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/file_kind.h"
#include "calibrato/recording/message_recording.h"
#include "calibrato/recording/recording_folder.h"
#include "calibrato/recording/video.h"

namespace calibrato {
namespace {

// Videos of cameras, in a folder that may have lists of IMUs as well.
Recording OpenVideos(const std::string& path, const std::vector<std::string>& videos,
                     const RecordingOptions& options) {
  Recording recording{path, {}, {}, {}};
  for (const std::string& video : videos) {
    recording.cameras.push_back({"cam" + std::to_string(recording.cameras.size()),
                                 OpenVideo(video, options, &recording.warnings), std::nullopt});
  }
  return recording;
}

}  // namespace

Recording OpenRecording(const std::string& path, const RecordingOptions& options) {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(path, error);
  if (is_folder && HoldsCameras(path)) return OpenRecordingFolder(path, options);
  if (auto logs = OpenMessageLogs(path); !logs.empty()) {
    return OpenMessageRecording(path, std::move(logs), options);
  }
  if (!is_folder) {
    if (KindOfFile(path) == FileKind::kVideo) return OpenVideos(path, {path}, options);
    throw InputError({"no recording", path, "it is neither a folder nor a file of a known kind",
                      "give a folder, a ROS 1 bag, a ROS 2 bag, an MCAP file or a video"});
  }
  if (options.with_cameras && options.image_globs.empty()) {
    if (const auto videos = VideosOfFolder(path); !videos.empty()) {
      Recording recording = OpenVideos(path, videos, options);
      if (options.with_imus) recording.imus = OpenImuRecordings(path);
      return recording;
    }
  }
  return OpenRecordingFolder(path, options);
}

}  // namespace calibrato
