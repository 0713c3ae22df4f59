#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace calibrato {

/// How the fields of a message stand in its bytes.
enum class MessageEncoding {
  kRos1,  ///< Little-endian, one field right behind the other.
  kCdr,   ///< ROS 2: a head of four bytes, then every number at a multiple of its size.
};

/// A topic of a bag whose messages are images or IMU samples; of others nothing is said.
struct LogTopic {
  std::string name;  ///< "/cam0/image_raw"
  std::string type;  ///< "Image", "CompressedImage" or "Imu" of sensor_msgs.
  MessageEncoding encoding = MessageEncoding::kRos1;
};

/// Where a message is in its bag.
struct MessagePlace {
  uint64_t container = 0;  ///< The number of its chunk, else as the bag's reader means it.
  uint64_t offset = 0;
  uint64_t size = 0;  ///< [bytes]
};

/// A bag: messages of several topics, one behind the other in a file. Private to the room.
///
/// To add a format: a class of this shape, and a line in message_recording.cc that knows a file of
/// it by its first bytes.
class MessageLog {
 public:
  /// @param topic  Of topics(); it stays where it is as long as the log.
  /// @param bytes  Valid during the call only.
  using Visit =
      std::function<void(const LogTopic& topic, const MessagePlace& place, std::string_view bytes)>;

  MessageLog() = default;
  virtual ~MessageLog() = default;
  MessageLog(const MessageLog&) = delete;
  MessageLog& operator=(const MessageLog&) = delete;

  /// Every message of images and IMUs, in the order of the file, with a few chunks in memory at a
  /// time. @throws InputError with the file: damaged, truncated, of an unknown compression.
  virtual void ForEach(const Visit& visit) = 0;

  /// One message again. Several threads may call it at once. @throws InputError
  [[nodiscard]] virtual std::string Read(const MessagePlace& place) const = 0;

  /// The file.
  [[nodiscard]] virtual const std::string& path() const = 0;

  /// What ForEach left out, and why; a line each.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 protected:
  std::vector<std::string> warnings_;
};

/// "Image", "CompressedImage" or "Imu" for the names that ROS 1 ("sensor_msgs/Image") and ROS 2
/// ("sensor_msgs/msg/Image") have for them; empty for all other types.
[[nodiscard]] std::string KnownMessageType(std::string_view name);

}  // namespace calibrato
