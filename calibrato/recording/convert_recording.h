#pragma once

#include <cstdint>
#include <string>

#include "calibrato/recording/recording.h"

namespace calibrato {

/// What a recording can be written as.
enum class RecordingForm {
  kFolder,   ///< cam0/STAMP.png, imu0.csv: docs/formats.md section 3.
  kRosbag1,  ///< A bag of ROS 1, for Kalibr and its kin.
  kMcap,     ///< MCAP with messages of ROS 2.
};

/// "folder", "rosbag1" or "mcap". @throws InputError
[[nodiscard]] RecordingForm RecordingFormFromName(const std::string& name);

struct ConversionResult {
  int64_t num_images = 0;
  int64_t num_imu_samples = 0;  ///< Of gyroscopes.
};

/// Writes a recording in another form, image by image: its memory does not grow with the length of
/// the recording, but for the IMU. Nothing is lost of what calibration reads:
/// - stamps, to the nanosecond; they become those of headers and of the messages themselves;
/// - image files, byte for byte: as CompressedImage in bags;
/// - raw pixels, bit for bit: as Image in bags, as PNG in folders, where cam0/sensor.yaml names the
///   encoding of mosaics; there, filling behind rows is left out;
/// - IMU samples, in their order, to the last bit; gyroscope and accelerometer of different stamps
///   as two lists or two topics.
/// Other topics of a bag, the orientation in Imu and the names of frames are left out. Cameras keep
/// their topics; others become /cam0/image_raw (with /compressed behind it for image files), IMUs
/// /imu0.
/// @param replace  False refuses a path that exists; true replaces a file, or a folder that holds a
/// recording.
/// @throws InputError: corner lists (bags have no form for them), photos without stamps, two names
/// or topics alike, images that cannot be read, the path or the disk; nothing is left behind.
ConversionResult ConvertRecording(const Recording& recording, RecordingForm form,
                                  const std::string& path, bool replace);

}  // namespace calibrato
