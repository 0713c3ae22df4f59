#include "calibrato/recording/mcap_reader.h"

#include <zlib.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/byte_fields.h"
#include "calibrato/recording/chunk_cache.h"
#include "calibrato/recording/mcap_format.h"
#include "calibrato/recording/random_access_file.h"

namespace calibrato {
namespace {

constexpr uint64_t kInFile = UINT64_MAX;  // a place outside of every chunk
constexpr uint64_t kMaxDescriptionBytes = uint64_t{16} << 20;

class Mcap : public MessageLog {
 public:
  explicit Mcap(const std::string& path)
      : file_(std::make_shared<const RandomAccessFile>(path)), cache_(file_) {}

  const std::string& path() const override { return file_->path(); }

  void ForEach(const Visit& visit) override {
    visit_ = &visit;
    try {
      CheckEnd();
      ReadRecords();
    } catch (const Damage& damage) {
      Fail(damage);
    }
  }

  std::string Read(const MessagePlace& place) const override {
    try {
      if (place.container == kInFile) return file_->Read(place.offset, place.size);
      return cache_.Get(chunks_.at(place.container))->substr(place.offset, place.size);
    } catch (const Damage& damage) {
      Fail(damage);
    }
  }

 private:
  [[noreturn]] void Fail(const Damage& damage) const {
    throw InputError({"cannot read MCAP file", path(), damage.why,
                      "copy it again, or save what is readable by 'mcap recover'"});
  }

  // A recorder that is stopped hard leaves no end.
  void CheckEnd() const {
    const uint64_t size = file_->size();
    if (size < 2 * kMcapMagic.size() ||
        file_->Read(size - kMcapMagic.size(), kMcapMagic.size()) != kMcapMagic) {
      throw Damage{"it is truncated: it does not end as such files do"};
    }
  }

  void ReadRecords() {
    uint64_t position = kMcapMagic.size();
    while (true) {
      const std::string head = file_->Read(position, kMcapRecordHeadBytes);
      ByteFields fields(head);
      const auto record = static_cast<McapRecord>(fields.Take<uint8_t>());
      const auto size = fields.Take<uint64_t>();
      const uint64_t begin = position + kMcapRecordHeadBytes;
      if (size > file_->size() - begin) {
        throw Damage{"it ends inside of the record at byte " + std::to_string(position)};
      }
      if (record == McapRecord::kDataEnd || record == McapRecord::kFooter) return;
      if (record == McapRecord::kChunk) {
        ReadChunk(begin, size);
      } else if (record == McapRecord::kMessage) {
        VisitMessage(file_->Read(begin, size), {kInFile, begin, size});
      } else if (record == McapRecord::kSchema || record == McapRecord::kChannel) {
        if (size > kMaxDescriptionBytes) throw Damage{"a description of a topic has no end"};
        Describe(record, file_->Read(begin, size));
      }
      // All others, also those that later versions add, say nothing of messages.
      position = begin + size;
    }
  }

  void ReadChunk(uint64_t begin, uint64_t size) {
    // All fields but the last: two times, the size, the checksum, the compression's name.
    constexpr uint64_t kMaxHeadBytes = 8 + 8 + 8 + 4 + 4 + 64 + 8;
    const std::string head = file_->Read(begin, std::min(size, kMaxHeadBytes));
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
    const auto number = chunks_.size();
    chunks_.push_back(chunk);
    const std::shared_ptr<const std::string> bytes = cache_.Get(chunk);
    const auto* data = reinterpret_cast<const Bytef*>(bytes->data());
    if (checksum != 0 && crc32_z(0, data, bytes->size()) != checksum) {
      throw Damage{"the checksum of the chunk at byte " + std::to_string(begin) +
                   " does not match"};
    }
    ReadChunkRecords(chunk, number, *bytes);
  }

  void ReadChunkRecords(const Chunk& chunk, size_t number, std::string_view bytes) {
    ByteFields fields(bytes);
    while (!fields.at_end()) {
      const auto record = static_cast<McapRecord>(fields.Take<uint8_t>());
      const auto content = fields.TakeBytes(fields.Take<uint64_t>());
      if (record == McapRecord::kSchema || record == McapRecord::kChannel) {
        Describe(record, content);
      } else if (record == McapRecord::kMessage) {
        // A message of a chunk that is not packed is read again without the rest of the chunk.
        const uint64_t offset = fields.position() - content.size();
        VisitMessage(content, chunk.compression == Compression::kNone
                                  ? MessagePlace{kInFile, chunk.offset + offset, content.size()}
                                  : MessagePlace{number, offset, content.size()});
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
    if (topic->second.type.empty()) return;
    (*visit_)(topic->second, place, content.substr(kMcapMessageHeadBytes));
  }

  std::shared_ptr<const RandomAccessFile> file_;
  ChunkCache cache_;
  std::vector<Chunk> chunks_;
  std::map<uint16_t, std::string> types_;  // by the schema's number
  std::map<uint16_t, LogTopic> topics_;    // by the channel's
  const Visit* visit_ = nullptr;
};

}  // namespace

std::unique_ptr<MessageLog> OpenMcap(const std::string& path) {
  return std::make_unique<Mcap>(path);
}

}  // namespace calibrato
