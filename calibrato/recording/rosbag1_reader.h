#pragma once

#include <memory>
#include <string>

#include "calibrato/recording/message_log.h"

namespace calibrato {

/// Reads a bag of ROS 1, format 2.0, packed by nothing, bz2 or lz4. It is read from its beginning,
/// so that its index is not needed: a bag that was never closed (index at 0) ends where its last
/// whole record does, with a warning. One with an index must be whole.
/// Source: the bag format of ROS, version 2.0 (wiki.ros.org/Bags/Format/2.0).
/// @pre KindOfFile(path) == FileKind::kRosbag1
/// @throws InputError if the file cannot be opened.
[[nodiscard]] std::unique_ptr<MessageLog> OpenRosbag1(const std::string& path);

}  // namespace calibrato
