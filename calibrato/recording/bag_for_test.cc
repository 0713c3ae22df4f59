#include "calibrato/recording/bag_for_test.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <bit>
#include <stdexcept>

namespace calibrato {
namespace {

constexpr int64_t kSecond = 1'000'000'000;

std::string LittleEndian(uint64_t value, int num_bytes) {
  std::string bytes;
  for (int i = 0; i < num_bytes; ++i) bytes += static_cast<char>(value >> (8 * i));
  return bytes;
}

std::string TimeOf(int64_t stamp) {
  return U32(static_cast<uint64_t>(stamp / kSecond)) + U32(static_cast<uint64_t>(stamp % kSecond));
}

std::string Ros1Header(int64_t stamp) { return U32(7) + TimeOf(stamp) + Sized("f"); }

}  // namespace

std::string U8(unsigned value) { return LittleEndian(value, 1); }
std::string U16(unsigned value) { return LittleEndian(value, 2); }
std::string U32(uint64_t value) { return LittleEndian(value, 4); }
std::string U64(uint64_t value) { return LittleEndian(value, 8); }
std::string F64(double value) { return U64(std::bit_cast<uint64_t>(value)); }
std::string Sized(const std::string& bytes) { return U32(bytes.size()) + bytes; }

std::string PackedByBzip2(const std::string& bytes) {
  std::string packed(bytes.size() + bytes.size() / 100 + 1000, '\0');
  auto size = static_cast<unsigned>(packed.size());
  if (BZ2_bzBuffToBuffCompress(packed.data(), &size, const_cast<char*>(bytes.data()),
                               static_cast<unsigned>(bytes.size()), 9, 0, 0) != BZ_OK) {
    throw std::runtime_error("cannot compress");
  }
  packed.resize(size);
  return packed;
}

std::string PackedByLz4(const std::string& bytes) {
  std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  const size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr);
  if (LZ4F_isError(size)) throw std::runtime_error("cannot compress");
  packed.resize(size);
  return packed;
}

std::string PackedByZstd(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3);
  if (ZSTD_isError(size)) throw std::runtime_error("cannot compress");
  packed.resize(size);
  return packed;
}

std::string Ros1Image(int64_t stamp, unsigned height, unsigned width, const std::string& encoding,
                      unsigned step, const std::string& data) {
  return Ros1Header(stamp) + U32(height) + U32(width) + Sized(encoding) + U8(0) + U32(step) +
         Sized(data);
}

std::string Ros1CompressedImage(int64_t stamp, const std::string& format, const std::string& data) {
  return Ros1Header(stamp) + Sized(format) + Sized(data);
}

std::string Ros1Imu(int64_t stamp, const std::vector<double>& values) {
  std::string bytes = Ros1Header(stamp);
  const std::string no_covariance(9 * 8, '\0');
  bytes += F64(0) + F64(0) + F64(0) + F64(1) + no_covariance;
  for (size_t k = 0; k < values.size(); ++k) {
    bytes += F64(values[k]);
    if (k % 3 == 2) bytes += no_covariance;
  }
  return bytes;
}

std::string BagRecord(const std::vector<std::pair<std::string, std::string>>& fields,
                      const std::string& data) {
  std::string header;
  for (const auto& [name, value] : fields) header += Sized(name + "=" + value);
  return Sized(header) + Sized(data);
}

std::string BagConnection(unsigned id, const std::string& topic, const std::string& type) {
  return BagRecord({{"op", U8(7)}, {"conn", U32(id)}, {"topic", topic}},
                   Sized("topic=" + topic) + Sized("type=" + type) + Sized("md5sum=*") +
                       Sized("message_definition="));
}

std::string BagMessage(unsigned connection, int64_t stamp, const std::string& data) {
  return BagRecord({{"op", U8(2)}, {"conn", U32(connection)}, {"time", TimeOf(stamp)}}, data);
}

std::string BagChunk(const std::string& compression, const std::string& packed, uint64_t size) {
  return BagRecord({{"op", U8(5)}, {"compression", compression}, {"size", U32(size)}}, packed);
}

std::string Bag(const std::vector<std::string>& records, unsigned num_chunks,
                const std::string& index) {
  std::string content;
  for (const std::string& record : records) content += record;
  const auto begin = [&](uint64_t index_position) {
    return "#ROSBAG V2.0\n" + BagRecord({{"op", U8(3)},
                                         {"index_pos", U64(index_position)},
                                         {"conn_count", U32(1)},
                                         {"chunk_count", U32(num_chunks)}},
                                        std::string(100, ' '));
  };
  if (index.empty()) return begin(0) + content;
  return begin(begin(0).size() + content.size()) + content + index;
}

std::string CdrImage(int64_t stamp, unsigned height, unsigned width, const std::string& encoding,
                     unsigned step, const std::string& data) {
  std::string body = TimeOf(stamp) + U32(4) + std::string("cam", 4) + U32(height) + U32(width) +
                     U32(encoding.size() + 1) + encoding + U8(0) + U8(0);
  while (body.size() % 4 != 0) body += '?';
  return std::string("\0\1\0\0", 4) + body + U32(step) + Sized(data);
}

std::string CdrImu(int64_t stamp, const std::vector<double>& values) {
  // Sixteen bytes of header: the doubles behind it need no filling.
  std::string bytes = std::string("\0\1\0\0", 4) + TimeOf(stamp) + U32(4) + std::string("cam", 4);
  const std::string no_covariance(9 * 8, '\0');
  bytes += std::string(4 * 8, '\0') + no_covariance;
  for (size_t k = 0; k < values.size(); ++k) {
    bytes += F64(values[k]);
    if (k % 3 == 2) bytes += no_covariance;
  }
  return bytes;
}

std::string McapRecordOf(unsigned opcode, const std::string& content) {
  return U8(opcode) + U64(content.size()) + content;
}

std::string McapSchema(unsigned id, const std::string& name) {
  return McapRecordOf(3, U16(id) + Sized(name) + Sized("ros2msg") + Sized("float64 x"));
}

std::string McapChannel(unsigned id, unsigned schema, const std::string& topic,
                        const std::string& encoding) {
  return McapRecordOf(4, U16(id) + U16(schema) + Sized(topic) + Sized(encoding) +
                             Sized(Sized("offered_qos_profiles") + Sized("")));
}

std::string McapMessage(unsigned channel, int64_t stamp, const std::string& data) {
  const std::string time = U64(static_cast<uint64_t>(stamp));
  return McapRecordOf(5, U16(channel) + U32(0) + time + time + data);
}

std::string McapChunk(const std::string& compression, const std::string& packed, uint64_t size,
                      uint32_t checksum) {
  return McapRecordOf(6, U64(1) + U64(2) + U64(size) + U32(checksum) + Sized(compression) +
                             U64(packed.size()) + packed);
}

std::string McapFile(const std::string& records) {
  const std::string magic = "\x89MCAP0\r\n";
  return magic + McapRecordOf(1, Sized("ros2") + Sized("by hand")) + records +
         McapRecordOf(0x0f, U32(0)) + McapRecordOf(2, U64(0) + U64(0) + U32(0)) + magic;
}

}  // namespace calibrato
