#pragma once

#include <string>

namespace calibrato {

/// What a file is, by its first bytes.
enum class FileKind {
  kRosbag1,     ///< A bag of ROS 1, format 2.0.
  kOldRosbag1,  ///< One of a format before that.
  kMcap,        ///< MCAP, version 0.
  kSqlite,      ///< A database of SQLite 3, as of a bag of ROS 2.
  kZstd,        ///< Anything packed by zstd.
  kVideo,       ///< A container of videos: MP4, QuickTime, Matroska, WebM, AVI, MPEG.
  kOther,
};

/// @throws InputError if the file cannot be read.
[[nodiscard]] FileKind KindOfFile(const std::string& path);

}  // namespace calibrato
