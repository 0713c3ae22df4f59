#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "calibrato/base/time.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// A camera that runs: one of this machine ("0", "/dev/video2"), or what a phone sends over the
/// network ("http://192.168.1.7:8080/video", "rtsp://.."). A video file serves as one as well.
///
/// A thread of its own takes frames as they come and stamps them at once, so that stamps do not
/// depend on what is done with the frames. Whoever asks gets the latest; those that came before it
/// unasked for are dropped, and counted. Of a file nothing is dropped: it waits.
class LiveCamera {
 public:
  /// How a device gives frames; called on the thread.
  struct Device {
    std::function<bool()> grab;  ///< Waits for the next frame; false once there is none.
    std::function<std::optional<GreyImage>()> retrieve;  ///< That frame; nothing if it is broken.
    bool may_drop = true;  ///< False: it is grabbed from only when the frame before was taken.
  };

  /// @throws InputError if it can't be opened.
  explicit LiveCamera(const std::string& device);
  explicit LiveCamera(Device device);
  /// Waits for a grab that is under way.
  ~LiveCamera();
  LiveCamera(const LiveCamera&) = delete;
  LiveCamera& operator=(const LiveCamera&) = delete;

  struct Frame {
    /// When this machine had it, on its system clock: exposure, read-out and transport came before.
    /// What is constant of that is a part of the time offset that is calibrated.
    Time stamp;
    GreyImage image;
    int num_dropped = 0;  ///< Since the frame before this one.
  };
  /// Waits for the next frame. @return nothing once the camera is gone, or the file at its end.
  [[nodiscard]] std::optional<Frame> Next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace calibrato
