#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "calibrato/recording/recording.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// One frame of a running camera, or of a recording that is played again.
struct CapturedFrame {
  Time stamp;
  std::optional<GreyImage> image;  ///< None where the recording is a list of corners ...
  std::optional<BoardView> view;   ///< ... which then has these.
  std::string file;                ///< The image as its file, where there is one; else empty.
  int num_dropped = 0;             ///< Frames before it that came too fast to be taken.
};

/// Where frames and, of recordings, IMU samples come from.
class FrameSource {
 public:
  FrameSource() = default;
  virtual ~FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  struct ImuSink {
    /// Of an IMU whose gyroscope and accelerometer have all their stamps in common ...
    std::function<void(const VectorSample& gyro, const VectorSample& accel)> both;
    /// ... and these of any other: a source calls the one or the two, never all three.
    std::function<void(const VectorSample& gyro)> gyro;
    std::function<void(const VectorSample& accel)> accel;
  };
  /// Waits for the next frame. IMU samples before it go to the sink.
  /// @param stop  Asked while a replay waits: once it says so, the frame comes at once.
  /// @return nothing at the end: the camera is gone, or the recording is over.
  /// @throws InputError what its reading throws.
  [[nodiscard]] virtual std::optional<CapturedFrame> Next(const ImuSink& sink,
                                                          const std::function<bool()>& stop) = 0;
  [[nodiscard]] virtual Resolution resolution() const = 0;
  /// What its end means, in words.
  [[nodiscard]] virtual std::string end_words() const = 0;
};

/// A running camera (recording/live_camera.h). @throws InputError if it gives no frame.
[[nodiscard]] std::unique_ptr<FrameSource> OpenCameraSource(const std::string& device);

/// Camera 0 and IMU 0 of a recording, in the order of their stamps.
/// @param speed  Of the clock: 1 as it was recorded, 0 as fast as it can be taken.
/// @param resolution  Of a list of corners that does not say it itself.
/// @throws InputError without stamps or image size.
[[nodiscard]] std::unique_ptr<FrameSource> OpenReplaySource(Recording recording, double speed,
                                                            std::optional<Resolution> resolution);

}  // namespace calibrato
