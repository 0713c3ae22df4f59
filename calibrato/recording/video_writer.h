#pragma once

#include <memory>
#include <string>

#include "calibrato/sensors/image.h"

namespace calibrato {

/// A video that any player shows: an AVI of JPEG pictures. The same pictures give the same bytes.
/// Such a file has a whole number of pictures a second. Pictures that come at another rate, or not
/// at all, leave the one before them standing, so that the video takes as long as what it shows.
class VideoWriter {
 public:
  /// Begins a file under its name; what stood there is lost. @throws InputError if it can't be
  /// written.
  /// @param rate_hz  Of the pictures that will come > 0: the video's, if it is whole; else the
  /// video has 30 a second, or as many more as it takes to show every one.
  VideoWriter(const std::string& path, Resolution resolution, double rate_hz);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// A picture that stands from t_s on [s], counted from the video's begin.
  /// @pre The video's resolution; no earlier than the picture before it.
  void Add(const RgbImage& image, double t_s);
  /// The last picture stands until end_s [s]. Nothing can be added after it.
  void Finish(double end_s);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace calibrato
