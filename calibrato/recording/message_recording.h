#pragma once

#include <memory>
#include <string>
#include <vector>

#include "calibrato/recording/message_log.h"
#include "calibrato/recording/recording.h"

namespace calibrato {

/// The bags in question: `path` itself, or those that lie in the folder `path` (a ROS 2 bag may be
/// in several files); empty if there are none. A file is known by its first bytes.
/// @throws InputError: a bag of a version, or packed in a way, that is not read; unreadable.
[[nodiscard]] std::vector<std::unique_ptr<MessageLog>> OpenMessageLogs(const std::string& path);

/// The recording in one or several bags of the same session: topics of sensor_msgs' Image,
/// CompressedImage and Imu, ROS 1 or ROS 2. Stamps are those of the messages' headers.
///
/// Which topics: those that the globs of the options choose, one each, in the order of the globs.
/// Without globs, the only topic of images (of IMUs), or all of them where their names differ in
/// digits alone (/cam0/image_raw, /cam1/image_raw), in the order of their numbers. Where there is a
/// choice beyond that, it is refused, and the topics listed. Two topics of Imu of which one is
/// called gyro where the other is called accel are one IMU whose sensors have stamps of their own.
/// @throws InputError: no topic of images, a choice, a glob that fits none or several, images of
/// one stamp (as where drivers leave stamps at 0); damaged bags.
[[nodiscard]] Recording OpenMessageRecording(const std::string& path,
                                             std::vector<std::unique_ptr<MessageLog>> logs,
                                             const RecordingOptions& options);

}  // namespace calibrato
