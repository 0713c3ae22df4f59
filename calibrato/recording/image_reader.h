#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/recording/stored_image.h"

namespace calibrato {

/// The images of one camera, read one at a time: a recording is never in memory as a whole.
///
/// To add a kind of recording: a class of this shape, a function that makes a Recording with it,
/// and a line in OpenRecording that knows the kind by its content.
class ImageReader {
 public:
  ImageReader() = default;
  virtual ~ImageReader() = default;
  ImageReader(const ImageReader&) = delete;
  ImageReader& operator=(const ImageReader&) = delete;

  /// Image number k in the order of CameraImages::list. Several threads may call it at once; near
  /// numbers in ascending order are cheapest.
  /// @throws InputError if it cannot be read.
  [[nodiscard]] virtual StoredImage Read(size_t k) const = 0;
};

/// What is known of an image before it is read.
struct RecordedImage {
  std::string name;  ///< File name without its folder, or the stamp: unique within the camera.
  Time stamp;        ///< 0 for photos without stamps.
};

struct CameraImages {
  std::vector<RecordedImage> list;  ///< Ascending in time; photos without stamps by name.
  /// In the order in which they were recorded, where that is another one: a clock was set back, or
  /// messages overtook each other. Else empty.
  std::vector<Time> stamps_as_recorded;
  std::shared_ptr<const ImageReader> reader;
};

}  // namespace calibrato
