#pragma once

#include <string>

namespace calibrato {

/// How bags describe a type of sensor_msgs to those who read them: "Image", "CompressedImage" or
/// "Imu". Private to the room.
struct MessageDefinition {
  std::string name;  ///< "sensor_msgs/Image", in ROS 2 "sensor_msgs/msg/Image".
  std::string text;  ///< Its fields, and those of the types that they are of.
  std::string md5;   ///< Of ROS 1: the fingerprint by which publisher and subscriber agree.
};

[[nodiscard]] MessageDefinition Ros1Definition(const std::string& type);
[[nodiscard]] MessageDefinition Ros2Definition(const std::string& type);

}  // namespace calibrato
