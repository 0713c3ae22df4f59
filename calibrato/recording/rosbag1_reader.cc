#include "calibrato/recording/rosbag1_reader.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "calibrato/recording/byte_fields.h"
#include "calibrato/recording/chunked_log.h"

namespace calibrato {
namespace {

constexpr uint64_t kMagicBytes = 13;  // "#ROSBAG V2.0" and the end of the line
constexpr uint64_t kMaxHeaderBytes = uint64_t{1} << 20;

// What a record is; 4 and 6 are indexes.
enum Operation : uint8_t {
  kMessage = 0x02,
  kBagHeader = 0x03,
  kChunk = 0x05,
  kConnection = 0x07,
};

struct Record {
  std::string header;
  uint8_t operation = 0;
  uint64_t data_begin = 0;
  uint64_t data_bytes = 0;
};

// name=value pairs, each behind its length.
class Header {
 public:
  explicit Header(std::string_view bytes) {
    ByteFields fields(bytes);
    while (!fields.at_end()) {
      const std::string_view field = fields.TakeString();
      const size_t equals = field.find('=');
      if (equals == std::string_view::npos) throw Damage{"a record's header is malformed"};
      values_.emplace_back(field.substr(0, equals), field.substr(equals + 1));
    }
  }
  std::string_view Text(std::string_view name) const {
    for (const auto& [key, value] : values_) {
      if (key == name) return value;
    }
    throw Damage{"a record has no field '" + std::string(name) + "'"};
  }
  template <typename T>
  T Number(std::string_view name) const {
    return ByteFields(Text(name)).Take<T>();
  }

 private:
  std::vector<std::pair<std::string_view, std::string_view>> values_;
};

class Rosbag1 final : public ChunkedLog {
 public:
  explicit Rosbag1(const std::string& path)
      : ChunkedLog(path, "cannot read bag",
                   "copy it again, or save what is readable by 'rosbag reindex'") {}

 private:
  void ReadRecords() override {
    uint64_t position = kMagicBytes;
    while (position < file().size()) {
      std::optional<Record> record;
      try {
        record = RecordAt(position);
      } catch (const Damage& damage) {
        if (is_closed_) throw;
        warnings_.push_back(path() + ": the bag was never closed, and is used up to byte " +
                            std::to_string(position) + ": " + damage.why);
        return;
      }
      ReadRecord(*record);
      position = record->data_begin + record->data_bytes;
    }
    if (is_closed_ && chunks().size() != num_chunks_claimed_) {
      throw Damage{"it has " + std::to_string(chunks().size()) + " chunks, its header says " +
                   std::to_string(num_chunks_claimed_)};
    }
  }

  Record RecordAt(uint64_t position) const {
    const auto header_bytes = ByteFields(file().Read(position, 4)).Take<uint32_t>();
    if (header_bytes > kMaxHeaderBytes) {
      throw Damage{"a record's header of " + std::to_string(header_bytes) +
                   " bytes begins at byte " + std::to_string(position)};
    }
    Record record;
    record.header = file().Read(position + 4, header_bytes);
    record.operation = Header(record.header).Number<uint8_t>("op");
    if (record.operation < kMessage || record.operation > kConnection) {
      throw Damage{"a record of an unknown kind begins at byte " + std::to_string(position)};
    }
    record.data_bytes = ByteFields(file().Read(position + 4 + header_bytes, 4)).Take<uint32_t>();
    record.data_begin = position + 8 + header_bytes;
    if (record.data_bytes > file().size() - record.data_begin) {
      throw Damage{"it ends inside of the record at byte " + std::to_string(position)};
    }
    return record;
  }

  void ReadRecord(const Record& record) {
    const Header header(record.header);
    const auto data = [&] { return file().Read(record.data_begin, record.data_bytes); };
    if (record.operation == kBagHeader) {
      const auto index_position = header.Number<uint64_t>("index_pos");
      is_closed_ = index_position != 0;
      num_chunks_claimed_ = header.Number<uint32_t>("chunk_count");
      if (index_position > file().size()) {
        throw Damage{"it ends before its index, which begins at byte " +
                     std::to_string(index_position)};
      }
    } else if (record.operation == kChunk) {
      ReadChunk(header, record);
    } else if (record.operation == kConnection) {
      AddConnection(header, data());
    } else if (record.operation == kMessage) {
      VisitMessage(header, InFile(record.data_begin, record.data_bytes), data());
    }
    // Indexes say nothing that the messages themselves do not.
  }

  void ReadChunk(const Header& header, const Record& record) {
    const std::string name(header.Text("compression").substr(0, 40));
    const std::optional<Compression> compression = CompressionFromName(name);
    if (!compression || *compression == Compression::kZstd) {
      throw Damage{"a chunk is packed by '" + name + "'"};
    }
    const Chunk chunk{record.data_begin, record.data_bytes, header.Number<uint32_t>("size"),
                      *compression};
    const size_t number = Add(chunk);
    if (chunk.size == 0 && chunk.packed_size == 0) return;  // It was still being written.
    const std::shared_ptr<const std::string> bytes = Unpacked(number);
    ByteFields fields(*bytes);
    while (!fields.at_end()) {
      const Header inner(fields.TakeString());
      const std::string_view data = fields.TakeString();
      const uint8_t operation = inner.Number<uint8_t>("op");
      if (operation == kConnection) AddConnection(inner, data);
      if (operation != kMessage) continue;
      VisitMessage(inner, InChunk(number, fields.position() - data.size(), data.size()), data);
    }
  }

  void AddConnection(const Header& header, std::string_view data) {
    const Header connection(data);
    const std::string type = KnownMessageType(connection.Text("type"));
    std::string topic(header.Text("topic"));
    // Later descriptions of a connection, as the index has them, repeat the first.
    topics_.try_emplace(header.Number<uint32_t>("conn"),
                        LogTopic{std::move(topic), type, MessageEncoding::kRos1});
  }

  void VisitMessage(const Header& header, const MessagePlace& place, std::string_view bytes) {
    const auto topic = topics_.find(header.Number<uint32_t>("conn"));
    if (topic == topics_.end()) throw Damage{"a message belongs to no connection"};
    Found(topic->second, place, bytes);
  }

  std::map<uint32_t, LogTopic> topics_;
  bool is_closed_ = false;
  uint64_t num_chunks_claimed_ = 0;
};

}  // namespace

std::unique_ptr<MessageLog> OpenRosbag1(const std::string& path) {
  return std::make_unique<Rosbag1>(path);
}

}  // namespace calibrato
