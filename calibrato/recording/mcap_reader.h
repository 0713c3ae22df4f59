#pragma once

#include <memory>
#include <string>

#include "calibrato/recording/message_log.h"

namespace calibrato {

/// Reads an MCAP file whose messages are of ROS 2 (cdr) or of ROS 1 (ros1), its chunks packed by
/// nothing, lz4 or zstd. It is read from its beginning, so that its summary is not needed; it must
/// be whole. Checksums are held against chunks that have one.
/// Source: the MCAP format specification (mcap.dev/spec).
/// @pre KindOfFile(path) == FileKind::kMcap
/// @throws InputError if the file cannot be opened.
[[nodiscard]] std::unique_ptr<MessageLog> OpenMcap(const std::string& path);

}  // namespace calibrato
