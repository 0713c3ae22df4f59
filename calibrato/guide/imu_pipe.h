#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "calibrato/sensors/imu.h"

namespace calibrato {

/// One IMU sample: gyroscope and accelerometer of one stamp.
struct ImuSample {
  VectorSample gyro;
  VectorSample accel;
};

/// A line "stamp [ns],w_x,w_y,w_z,a_x,a_y,a_z", as in imu0.csv. @return nothing for any other line.
[[nodiscard]] std::optional<ImuSample> ParseImuLine(std::string_view line);

/// An IMU that runs: lines from a pipe that its driver's program writes, read as they come on a
/// thread of its own. Comments and a header are passed over.
class ImuPipe {
 public:
  /// @param path  A named pipe, or "-" for the standard input.
  /// @param on_sample  Called for each sample, on the thread.
  /// @param on_bad_line  Called for each line that is none.
  /// @throws InputError if it can't be opened.
  ImuPipe(const std::string& path, std::function<void(const ImuSample&)> on_sample,
          std::function<void()> on_bad_line);
  ~ImuPipe();
  ImuPipe(const ImuPipe&) = delete;
  ImuPipe& operator=(const ImuPipe&) = delete;

 private:
  void Read();
  void TakeLine(std::string_view line);

  int fd_ = -1;
  std::function<void(const ImuSample&)> on_sample_;
  std::function<void()> on_bad_line_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace calibrato
