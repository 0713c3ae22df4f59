#include "calibrato/recording/recording.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/message_recording.h"
#include "calibrato/recording/recording_folder.h"

namespace calibrato {
Recording OpenRecording(const std::string& path, const RecordingOptions& options) {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(path, error);
  if (is_folder && HoldsCameras(path)) return OpenRecordingFolder(path, options);
  if (auto logs = OpenMessageLogs(path); !logs.empty()) {
    return OpenMessageRecording(path, std::move(logs), options);
  }
  if (!is_folder) {
    throw InputError({"no recording", path, "it is neither a folder nor a file of a known kind",
                      "give a folder, a ROS 1 bag, a ROS 2 bag, an MCAP file or a video"});
  }
  return OpenRecordingFolder(path, options);
}

}  // namespace calibrato
