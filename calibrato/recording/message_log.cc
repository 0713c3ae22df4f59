#include "calibrato/recording/message_log.h"

namespace calibrato {

std::string KnownMessageType(std::string_view name) {
  for (const std::string_view package : {"sensor_msgs/msg/", "sensor_msgs/"}) {
    if (!name.starts_with(package)) continue;
    name.remove_prefix(package.size());
    if (name == "Image" || name == "CompressedImage" || name == "Imu") return std::string(name);
    return "";
  }
  return "";
}

}  // namespace calibrato
