#include "calibrato/recording/recording.h"

#include "calibrato/recording/recording_folder.h"

namespace calibrato {

Recording OpenRecording(const std::string& path, const RecordingOptions& options) {
  return OpenRecordingFolder(path, options);
}

}  // namespace calibrato
