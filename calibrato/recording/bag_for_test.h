#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace calibrato {

// For tests: bags put together byte by byte from the published formats, without the code that
// writes them for users.

/// Little-endian numbers.
std::string U8(unsigned value);
std::string U16(unsigned value);
std::string U32(uint64_t value);
std::string U64(uint64_t value);
std::string F64(double value);
/// Text or bytes behind their length of 32 bits.
std::string Sized(const std::string& bytes);

/// Packs as bags do; lz4 and zstd by one frame.
std::string PackedByBzip2(const std::string& bytes);
std::string PackedByLz4(const std::string& bytes);
std::string PackedByZstd(const std::string& bytes);

/// Messages as ROS 1 has them: sequence 7, stamp in nanoseconds, frame "f".
std::string Ros1Image(int64_t stamp, unsigned height, unsigned width, const std::string& encoding,
                      unsigned step, const std::string& data);
std::string Ros1CompressedImage(int64_t stamp, const std::string& format, const std::string& data);
/// @param values  Angular velocity, then linear acceleration.
std::string Ros1Imu(int64_t stamp, const std::vector<double>& values);

/// A record of a ROS 1 bag: header fields (name, value) and data.
std::string BagRecord(const std::vector<std::pair<std::string, std::string>>& fields,
                      const std::string& data);
std::string BagConnection(unsigned id, const std::string& topic, const std::string& type);
std::string BagMessage(unsigned connection, int64_t stamp, const std::string& data);
std::string BagChunk(const std::string& compression, const std::string& packed, uint64_t size);
/// @param index  What follows the chunks: connections, mostly. Without, the bag was never closed.
std::string Bag(const std::vector<std::string>& records, unsigned num_chunks,
                const std::string& index);

/// Messages as ROS 2 has them, little-endian; frame "cam".
std::string CdrImage(int64_t stamp, unsigned height, unsigned width, const std::string& encoding,
                     unsigned step, const std::string& data);
std::string CdrImu(int64_t stamp, const std::vector<double>& values);

/// A record of an MCAP file; schema, channel, message and chunk (checksum 0: none).
std::string McapRecordOf(unsigned opcode, const std::string& content);
std::string McapSchema(unsigned id, const std::string& name);
std::string McapChannel(unsigned id, unsigned schema, const std::string& topic,
                        const std::string& encoding = "cdr");
std::string McapMessage(unsigned channel, int64_t stamp, const std::string& data);
std::string McapChunk(const std::string& compression, const std::string& packed, uint64_t size,
                      uint32_t checksum = 0);
/// The file of these records, with header, end of data, an empty summary, and footer.
std::string McapFile(const std::string& records);

}  // namespace calibrato
