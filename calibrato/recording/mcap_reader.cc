#include "calibrato/recording/mcap_reader.h"

#include <zlib.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "calibrato/recording/byte_fields.h"
#include "calibrato/recording/chunked_log.h"
#include "calibrato/recording/mcap_format.h"

namespace calibrato {
namespace {

constexpr uint64_t kMaxDescriptionBytes = uint64_t{16} << 20;

class Mcap final : public ChunkedLog {
 public:
  explicit Mcap(const std::string& path)
      : ChunkedLog(path, "cannot read MCAP file",
                   "copy it again, or save what is readable by 'mcap recover'") {}

 private:
  // A recorder that is stopped hard leaves no end.
  void CheckEnd() const {
    const uint64_t size = file().size();
    if (size < 2 * kMcapMagic.size() ||
        file().Read(size - kMcapMagic.size(), kMcapMagic.size()) != kMcapMagic) {
      throw Damage{"it is truncated: it does not end as such files do"};
    }
  }

  void ReadRecords() override {
    CheckEnd();
    uint64_t position = kMcapMagic.size();
    while (true) {
      const std::string head = file().Read(position, kMcapRecordHeadBytes);
      ByteFields fields(head);
      const auto record = static_cast<McapRecord>(fields.Take<uint8_t>());
      const auto size = fields.Take<uint64_t>();
      const uint64_t begin = position + kMcapRecordHeadBytes;
      if (size > file().size() - begin) {
        throw Damage{"it ends inside of the record at byte " + std::to_string(position)};
      }
      if (record == McapRecord::kDataEnd || record == McapRecord::kFooter) return;
      if (record == McapRecord::kChunk) {
        ReadChunk(begin, size);
      } else if (record == McapRecord::kMessage) {
        VisitMessage(file().Read(begin, size), InFile(begin, size));
      } else if (record == McapRecord::kSchema || record == McapRecord::kChannel) {
        if (size > kMaxDescriptionBytes) throw Damage{"a description of a topic has no end"};
        Describe(record, file().Read(begin, size));
      }
      // All others, also those that later versions add, say nothing of messages.
      position = begin + size;
    }
  }

  void ReadChunk(uint64_t begin, uint64_t size) {
    // All fields but the last: two times, the size, the checksum, the compression's name.
    constexpr uint64_t kMaxHeadBytes = 8 + 8 + 8 + 4 + 4 + 64 + 8;
    const std::string head = file().Read(begin, std::min(size, kMaxHeadBytes));
    ByteFields fields(head);
    fields.TakeBytes(8 + 8);
    Chunk chunk;
    chunk.size = fields.Take<uint64_t>();
    const auto checksum = fields.Take<uint32_t>();
    const std::string name(fields.TakeString());
    chunk.packed_size = fields.Take<uint64_t>();
    chunk.offset = begin + fields.position();
    const std::optional<Compression> compression = CompressionFromName(name);
    if (!compression || *compression == Compression::kBzip2) {
      throw Damage{"a chunk is packed by '" + name + "'"};
    }
    chunk.compression = *compression;
    if (chunk.packed_size > size - fields.position()) {
      throw Damage{"a chunk is larger than its record"};
    }
    const size_t number = Add(chunk);
    const std::shared_ptr<const std::string> bytes = Unpacked(number);
    const auto* data = reinterpret_cast<const Bytef*>(bytes->data());
    if (checksum != 0 && crc32_z(0, data, bytes->size()) != checksum) {
      throw Damage{"the checksum of the chunk at byte " + std::to_string(begin) +
                   " does not match"};
    }
    ReadChunkRecords(number, *bytes);
  }

  void ReadChunkRecords(size_t chunk, std::string_view bytes) {
    ByteFields fields(bytes);
    while (!fields.at_end()) {
      const auto record = static_cast<McapRecord>(fields.Take<uint8_t>());
      const auto content = fields.TakeBytes(fields.Take<uint64_t>());
      if (record == McapRecord::kSchema || record == McapRecord::kChannel) {
        Describe(record, content);
      } else if (record == McapRecord::kMessage) {
        const uint64_t offset = fields.position() - content.size();
        VisitMessage(content, InChunk(chunk, offset, content.size()));
      }
    }
  }

  void Describe(McapRecord record, std::string_view content) {
    ByteFields fields(content);
    const auto id = fields.Take<uint16_t>();
    if (record == McapRecord::kSchema) {
      types_.try_emplace(id, KnownMessageType(fields.TakeString()));
      return;
    }
    const auto schema = types_.find(fields.Take<uint16_t>());
    const std::string topic(fields.TakeString());
    const std::string_view encoding = fields.TakeString();
    // Without a schema, or of an encoding like JSON, it is none of ours.
    const bool is_known = schema != types_.end() && (encoding == "cdr" || encoding == "ros1");
    topics_.try_emplace(
        id, LogTopic{topic, is_known ? schema->second : "",
                     encoding == "ros1" ? MessageEncoding::kRos1 : MessageEncoding::kCdr});
  }

  // The place is given of the record's content, of which the data are the end.
  void VisitMessage(std::string_view content, MessagePlace place) {
    ByteFields fields(content);
    const auto topic = topics_.find(fields.Take<uint16_t>());
    if (topic == topics_.end()) throw Damage{"a message belongs to no channel"};
    fields.TakeBytes(kMcapMessageHeadBytes - sizeof(uint16_t));
    place.offset += kMcapMessageHeadBytes;
    place.size -= kMcapMessageHeadBytes;
    Found(topic->second, place, content.substr(kMcapMessageHeadBytes));
  }

  std::map<uint16_t, std::string> types_;  // by the schema's number
  std::map<uint16_t, LogTopic> topics_;    // by the channel's
};

}  // namespace

std::unique_ptr<MessageLog> OpenMcap(const std::string& path) {
  return std::make_unique<Mcap>(path);
}

}  // namespace calibrato
