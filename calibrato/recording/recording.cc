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

// An option that chooses among what a recording of this kind does not have.
void RefuseUnused(bool is_given, const std::string& option, const std::string& path,
                  const std::string& kind) {
  if (!is_given) return;
  throw InputError(
      {option + " has nothing to choose from", path, "it is " + kind, "leave " + option + " out"});
}

Recording OpenFolder(const std::string& path, const RecordingOptions& options) {
  RefuseUnused(!options.imu_globs.empty(), "--imu-topic", path, "a folder, without topics");
  RefuseUnused(options.frame_rate_hz.has_value(), "--frame-rate", path, "a folder without videos");
  return OpenRecordingFolder(path, options);
}

// Videos of cameras, in a folder that may have lists of IMUs as well.
Recording OpenVideos(const std::string& path, const std::vector<std::string>& videos,
                     const RecordingOptions& options) {
  RefuseUnused(!options.image_globs.empty(), "--images", path, "a video");
  RefuseUnused(!options.imu_globs.empty(), "--imu-topic", path, "a video, without topics");
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
  if (is_folder && HoldsCameras(path)) return OpenFolder(path, options);
  if (auto logs = OpenMessageLogs(path); !logs.empty()) {
    RefuseUnused(options.frame_rate_hz.has_value(), "--frame-rate", path, "a bag, with stamps");
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
  return OpenFolder(path, options);
}

}  // namespace calibrato
