#pragma once

#include <cstdint>
#include <string_view>

namespace calibrato {

// Names of the MCAP format, for its reader and its writer (mcap.dev/spec). Private to the room.

/// Begins and ends a file.
inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

/// What a record is: its first byte, before its length of 64 bits.
enum class McapRecord : uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f,
};

/// Bytes of a record before its content.
inline constexpr uint64_t kMcapRecordHeadBytes = 9;

/// Bytes of a message before its data: channel, sequence, two times.
inline constexpr uint64_t kMcapMessageHeadBytes = 22;

}  // namespace calibrato
