#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "calibrato/base/time.h"
#include "calibrato/recording/message_log.h"
#include "calibrato/recording/stored_image.h"

namespace calibrato {

// The three messages of sensor_msgs that a recording is made of, from their bytes and into them, as
// ROS 1 and ROS 2 (CDR) lay them out. Sources: sensor_msgs' message files; the serialisation of ROS
// 1; OMG, Common Data Representation, section 7.4 of DDS-XTypes 1.2, plain CDR version 1.
// All that read throw Damage where the bytes end too early. Private to the room.

/// The stamp of the header with which all three begin.
[[nodiscard]] Time StampOfMessage(MessageEncoding encoding, std::string_view bytes);

/// An Image.
struct ImageMessage {
  Time stamp;
  std::string frame_id;
  RawPixels pixels;
};
[[nodiscard]] ImageMessage ReadImageMessage(MessageEncoding encoding, std::string_view bytes);
/// @param sequence  The header's number, which only ROS 1 has.
[[nodiscard]] std::string ImageMessageBytes(MessageEncoding encoding, const ImageMessage& image,
                                            uint32_t sequence);

/// A CompressedImage. Its format ("bayer_rggb8; png compressed ") names the encoding before it was
/// packed; of that, only mosaics are kept.
struct CompressedImageMessage {
  Time stamp;
  std::string frame_id;
  EncodedFile file;
};
[[nodiscard]] CompressedImageMessage ReadCompressedImageMessage(MessageEncoding encoding,
                                                                std::string_view bytes);
[[nodiscard]] std::string CompressedImageMessageBytes(MessageEncoding encoding,
                                                      const CompressedImageMessage& image,
                                                      uint32_t sequence);

/// An Imu, without its orientation, which no calibration uses. A covariance that begins with -1
/// says, by ROS's convention, that the sensor gave no value: nothing here.
struct ImuMessage {
  Time stamp;
  std::string frame_id;
  std::optional<Eigen::Vector3d> gyro;   ///< [rad/s]
  std::optional<Eigen::Vector3d> accel;  ///< [m/s^2]
};
[[nodiscard]] ImuMessage ReadImuMessage(MessageEncoding encoding, std::string_view bytes);
[[nodiscard]] std::string ImuMessageBytes(MessageEncoding encoding, const ImuMessage& imu,
                                          uint32_t sequence);

}  // namespace calibrato
