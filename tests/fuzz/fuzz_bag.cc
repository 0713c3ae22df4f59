// A bag of ROS 1, an MCAP file or a database of ROS 2, as the corpus has them: opened, and its
// images read.

#include "calibrato/base/input_error.h"
#include "calibrato/recording/file_kind.h"
#include "calibrato/recording/recording.h"
#include "file_of_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const calibrato::FileOfBytes file(data, size);
  // Videos are FFmpeg's, which has fuzzers of its own.
  if (calibrato::KindOfFile(file.path()) == calibrato::FileKind::kVideo) return 0;
  try {
    const calibrato::Recording recording = calibrato::OpenRecording(file.path(), {});
    for (const calibrato::CameraRecording& camera : recording.cameras) {
      const auto* images = std::get_if<calibrato::CameraImages>(&camera.data);
      if (images == nullptr) continue;
      for (size_t k = 0; k < images->list.size(); ++k) {
        try {
          static_cast<void>(GreyOf(images->reader->Read(k)));
        } catch (const calibrato::InputError&) {
        }
      }
    }
  } catch (const calibrato::InputError&) {
  }
  return 0;
}
