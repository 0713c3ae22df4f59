#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "calibrato/base/time.h"
#include "calibrato/recording/message_log.h"

namespace calibrato {

/// Writes a bag: topics of sensor_msgs' Image, CompressedImage and Imu, and their messages in any
/// order. The bag appears under its name when it is complete. Private to the room.
///
/// To add a format: a class of this shape, and a line in convert_recording.cc.
class MessageBagWriter {
 public:
  MessageBagWriter() = default;
  virtual ~MessageBagWriter() = default;
  MessageBagWriter(const MessageBagWriter&) = delete;
  MessageBagWriter& operator=(const MessageBagWriter&) = delete;

  /// How messages are to be encoded (recording/ros_messages.h).
  [[nodiscard]] virtual MessageEncoding encoding() const = 0;
  /// @param type  "Image", "CompressedImage" or "Imu".
  /// @return The topic's number.
  [[nodiscard]] virtual size_t AddTopic(const std::string& name, const std::string& type) = 0;
  /// @param time  When it counts as recorded; by it players order messages.
  virtual void Write(size_t topic, Time time, std::string_view message) = 0;
  /// Writes the index and gives the file its name. Nothing may follow. All that write throw
  /// InputError.
  virtual void Close() = 0;
};

/// A bag of ROS 1, format 2.0, in chunks that are not packed, with index.
[[nodiscard]] std::unique_ptr<MessageBagWriter> NewRosbag1(const std::string& path);

/// An MCAP file of profile ros2, in chunks that are not packed, with checksums and summary.
[[nodiscard]] std::unique_ptr<MessageBagWriter> NewMcap(const std::string& path);

}  // namespace calibrato
