#pragma once

#include <memory>
#include <optional>
#include <string>

#include "calibrato/base/time.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// A camera that runs: one of this machine ("0", "/dev/video2"), or what a phone sends over the
/// network ("http://192.168.1.7:8080/video", "rtsp://.."). A video file serves as one as well.
class LiveCamera {
 public:
  /// @throws InputError if it can't be opened.
  explicit LiveCamera(const std::string& device);
  ~LiveCamera();
  LiveCamera(const LiveCamera&) = delete;
  LiveCamera& operator=(const LiveCamera&) = delete;

  struct Frame {
    /// When this machine had it, on its system clock: exposure, read-out and transport came before.
    /// What is constant of that is a part of the time offset that is calibrated.
    Time stamp;
    GreyImage image;
  };
  /// Waits for the next frame. @return nothing once the camera is gone, or the file at its end.
  [[nodiscard]] std::optional<Frame> Next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace calibrato
