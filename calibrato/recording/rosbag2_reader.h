#pragma once

#include <memory>
#include <string>

#include "calibrato/recording/message_log.h"

namespace calibrato {

/// Reads a bag of ROS 2 that is a database of SQLite: its tables `topics` (id, name, type,
/// serialization_format) and `messages` (id, topic_id, data), messages in CDR.
/// Source: the tables that rosbag2_storage_sqlite3 makes.
/// @pre KindOfFile(path) == FileKind::kSqlite
/// @throws InputError if the file cannot be opened.
[[nodiscard]] std::unique_ptr<MessageLog> OpenRosbag2Database(const std::string& path);

}  // namespace calibrato
