#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "calibrato/sensors/image.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// A recording folder that is written while its sensors run: cam0/STAMP.png image by image, or
/// cam0_corners.csv view by view; imu0.csv (or gyro0.csv and accel0.csv) sample by sample. Once
/// each sensor has a sample, the folder is at every moment, and after any end, a recording that
/// OpenRecording reads: an image has its name only once it is complete, and rows are appended whole
/// (empty lines keep them from lying on two pages of the file, where a write can be cut in two).
/// What was handed over before the process was killed is kept; so is, up to the last whole row,
/// what was there when the disk was full; a list whose first row did not fit is gone again.
class GrowingRecording {
 public:
  /// Makes the folder.
  /// @param resolution  Kept in sensor.yaml, for lists of corners.
  /// @param corners_per_tag  As CornerListText.
  /// @throws InputError if it exists and is not empty, or can't be made.
  GrowingRecording(std::string path, Resolution resolution, int corners_per_tag);
  ~GrowingRecording();
  GrowingRecording(const GrowingRecording&) = delete;
  GrowingRecording& operator=(const GrowingRecording&) = delete;

  /// All throw InputError: the disk is full, and what else can happen to one.
  void AddImage(Time stamp, const GreyImage& image);
  /// @param bytes  PNG, JPEG, .. as its first bytes tell; kept as it is.
  void AddImageFile(Time stamp, std::string_view bytes);
  void AddView(const BoardView& view);
  /// Gyroscope and accelerometer of one stamp.
  void AddImu(const VectorSample& gyro, const VectorSample& accel);
  void AddGyro(const VectorSample& gyro);
  void AddAccel(const VectorSample& accel);

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  void AppendRows(const std::string& name, std::string_view rows_with_header);

  std::string path_;
  int corners_per_tag_ = 1;
  std::mutex mutex_;                  // Of the lists: sensors have threads of their own.
  std::map<std::string, int> lists_;  // Name to file descriptor.
};

}  // namespace calibrato
