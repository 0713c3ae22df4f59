#pragma once

#include <memory>
#include <string>

#include "calibrato/sensors/image.h"

namespace calibrato {

/// A video that any player shows: an AVI of JPEG pictures. The same pictures give the same bytes.
class VideoWriter {
 public:
  /// Begins a file under its name; what stood there is lost. @throws InputError if it can't be
  /// written.
  VideoWriter(const std::string& path, Resolution resolution, double rate_hz);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// @pre The video's resolution.
  void Add(const RgbImage& image);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace calibrato
