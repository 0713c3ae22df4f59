#pragma once

#include <string>

#include "calibrato/recording/recording.h"

namespace calibrato {

/// Writes cameras as cam0/STAMP.png (or another image file, as it is in the recording), IMUs as
/// imu0.csv, or as gyro0.csv and accel0.csv where their stamps differ. The folder appears under its
/// name when it is complete, in place of what stood there. Private to the room; callers use
/// ConvertRecording.
/// @pre The recording has images with stamps, not corners.
/// @throws InputError: an image that cannot be read or has no known format, the disk.
void WriteRecordingFolder(const Recording& recording, const std::string& path);

/// True if each gyroscope sample has the stamp of the accelerometer sample of its number.
[[nodiscard]] bool HasCommonStamps(const ImuStream& stream);

}  // namespace calibrato
