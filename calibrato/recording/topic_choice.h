#pragma once

#include <string>
#include <vector>

namespace calibrato {

// Which topics of a bag are the recording's cameras and IMUs. Private to the room; the rules stand
// at OpenMessageRecording.

/// The topics of the cameras, in their order.
/// @param topics  All that have images.
/// @throws InputError that lists the topics: none, a choice, a glob that fits none or several.
[[nodiscard]] std::vector<std::string> ChooseImageTopics(const std::string& path,
                                                         const std::vector<std::string>& topics,
                                                         const std::vector<std::string>& globs);

/// Where an IMU's two sensors are: one topic, or two.
struct ImuTopics {
  std::string gyro;
  std::string accel;
};

/// The same of the IMUs; none at all is no error without globs.
[[nodiscard]] std::vector<ImuTopics> ChooseImuTopics(const std::string& path,
                                                     const std::vector<std::string>& topics,
                                                     const std::vector<std::string>& globs);

/// The accelerometer's topic beside a gyroscope's: "gyro" replaced by "accel"; empty if the name
/// has no "gyro".
[[nodiscard]] std::string AccelTopicOf(std::string gyro_topic);

}  // namespace calibrato
