#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "calibrato/recording/byte_fields.h"
#include "calibrato/recording/mcap_format.h"
#include "calibrato/recording/message_definitions.h"
#include "calibrato/recording/message_writer.h"
#include "calibrato/recording/new_file.h"

namespace calibrato {
namespace {

constexpr size_t kMaxChunkBytes = size_t{1} << 20;

void PutRecord(McapRecord record, std::string_view content, std::string* bytes) {
  Put(static_cast<uint8_t>(record), bytes);
  Put(uint64_t{content.size()}, bytes);
  *bytes += content;
}

uint32_t Checksum(std::string_view bytes) {
  return static_cast<uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

struct Channel {
  std::string schema;   // its record
  std::string channel;  // likewise
  uint64_t num_messages = 0;
};

struct IndexEntry {
  uint64_t time = 0;
  uint64_t offset = 0;  // in the chunk
};

// The earliest and the latest time of some messages; zeros of none.
struct Span {
  uint64_t begin = 0;
  uint64_t end = 0;
  bool is_empty = true;

  void Add(uint64_t time) {
    begin = is_empty ? time : std::min(begin, time);
    end = is_empty ? time : std::max(end, time);
    is_empty = false;
  }
};

class McapWriter : public MessageBagWriter {
 public:
  explicit McapWriter(const std::string& path) : file_(path) {
    std::string begin(kMcapMagic);
    std::string header;
    PutString("ros2", &header);
    PutString("calibrato", &header);
    PutRecord(McapRecord::kHeader, header, &begin);
    file_.Append(begin);
  }

  MessageEncoding encoding() const override { return MessageEncoding::kCdr; }

  size_t AddTopic(const std::string& name, const std::string& type) override {
    // A schema for each channel, of the same number: numbers of schemas begin with 1.
    const auto number = static_cast<uint16_t>(channels_.size() + 1);
    const MessageDefinition definition = Ros2Definition(type);
    std::string schema;
    Put(number, &schema);
    PutString(definition.name, &schema);
    PutString("ros2msg", &schema);
    PutString(definition.text, &schema);
    std::string channel;
    Put(number, &channel);
    Put(number, &channel);
    PutString(name, &channel);
    PutString("cdr", &channel);
    PutString("", &channel);  // no metadata
    Channel added;
    PutRecord(McapRecord::kSchema, schema, &added.schema);
    PutRecord(McapRecord::kChannel, channel, &added.channel);
    channels_.push_back(std::move(added));
    return channels_.size() - 1;
  }

  void Write(size_t topic, Time time, std::string_view message) override {
    Channel& channel = channels_[topic];
    if (channel.num_messages == 0) chunk_ += channel.schema + channel.channel;
    const auto nanoseconds = static_cast<uint64_t>(time.nanoseconds());
    index_[topic].push_back({nanoseconds, chunk_.size()});
    span_.Add(nanoseconds);
    whole_span_.Add(nanoseconds);
    Put(static_cast<uint8_t>(McapRecord::kMessage), &chunk_);
    Put(kMcapMessageHeadBytes + message.size(), &chunk_);
    Put(static_cast<uint16_t>(topic + 1), &chunk_);
    Put(static_cast<uint32_t>(channel.num_messages), &chunk_);
    Put(nanoseconds, &chunk_);
    Put(nanoseconds, &chunk_);
    chunk_ += message;
    ++channel.num_messages;
    if (chunk_.size() >= kMaxChunkBytes) EndChunk();
  }

  void Close() override {
    if (!chunk_.empty()) EndChunk();
    std::string end;
    PutRecord(McapRecord::kDataEnd, std::string(4, '\0'), &end);
    file_.Append(end);
    file_.Append(SummaryAndFooter(file_.size()));
    file_.Append(kMcapMagic);
    file_.Commit();
  }

 private:
  void EndChunk() {
    std::string head;
    Put(span_.begin, &head);
    Put(span_.end, &head);
    Put(uint64_t{chunk_.size()}, &head);
    Put(Checksum(chunk_), &head);
    PutString("", &head);  // not packed
    Put(uint64_t{chunk_.size()}, &head);
    const uint64_t position = file_.size();
    std::string begin;
    Put(static_cast<uint8_t>(McapRecord::kChunk), &begin);
    Put(uint64_t{head.size() + chunk_.size()}, &begin);
    file_.Append(begin + head);
    file_.Append(chunk_);
    const uint64_t end = file_.size();
    std::string indexes;
    std::string offsets;
    for (const auto& [topic, entries] : index_) {
      Put(static_cast<uint16_t>(topic + 1), &offsets);
      Put(end + indexes.size(), &offsets);
      std::string content;
      Put(static_cast<uint16_t>(topic + 1), &content);
      Put(static_cast<uint32_t>(entries.size() * 2 * sizeof(uint64_t)), &content);
      for (const IndexEntry& entry : entries) {
        Put(entry.time, &content);
        Put(entry.offset, &content);
      }
      PutRecord(McapRecord::kMessageIndex, content, &indexes);
    }
    file_.Append(indexes);
    std::string info;
    Put(span_.begin, &info);
    Put(span_.end, &info);
    Put(position, &info);
    Put(end - position, &info);
    PutString(offsets, &info);
    Put(uint64_t{indexes.size()}, &info);
    PutString("", &info);
    Put(uint64_t{chunk_.size()}, &info);
    Put(uint64_t{chunk_.size()}, &info);
    PutRecord(McapRecord::kChunkIndex, info, &chunk_indexes_);
    ++num_chunks_;
    chunk_.clear();
    index_.clear();
    span_ = {};
  }

  std::string Statistics() const {
    uint64_t num_messages = 0;
    uint32_t num_channels = 0;
    std::string counts;
    for (size_t k = 0; k < channels_.size(); ++k) {
      if (channels_[k].num_messages == 0) continue;
      num_messages += channels_[k].num_messages;
      ++num_channels;
      Put(static_cast<uint16_t>(k + 1), &counts);
      Put(channels_[k].num_messages, &counts);
    }
    std::string content;
    Put(num_messages, &content);
    Put(static_cast<uint16_t>(num_channels), &content);  // schemas
    Put(num_channels, &content);
    Put(uint32_t{0}, &content);  // attachments
    Put(uint32_t{0}, &content);  // metadata
    Put(num_chunks_, &content);
    Put(whole_span_.begin, &content);
    Put(whole_span_.end, &content);
    PutString(counts, &content);
    std::string record;
    PutRecord(McapRecord::kStatistics, content, &record);
    return record;
  }

  // All that lets a reader find its way without reading the rest.
  std::string SummaryAndFooter(uint64_t begin) const {
    std::map<McapRecord, std::string> groups;
    for (const Channel& channel : channels_) {
      if (channel.num_messages == 0) continue;
      groups[McapRecord::kSchema] += channel.schema;
      groups[McapRecord::kChannel] += channel.channel;
    }
    groups[McapRecord::kStatistics] = Statistics();
    groups[McapRecord::kChunkIndex] = chunk_indexes_;
    std::string summary;
    std::string offsets;
    for (const auto& [record, bytes] : groups) {
      if (bytes.empty()) continue;
      std::string content;
      Put(static_cast<uint8_t>(record), &content);
      Put(begin + summary.size(), &content);
      Put(uint64_t{bytes.size()}, &content);
      PutRecord(McapRecord::kSummaryOffset, content, &offsets);
      summary += bytes;
    }
    const uint64_t offsets_begin = begin + summary.size();
    summary += offsets;
    // The checksum covers the footer up to itself.
    constexpr uint64_t kFooterBytes = 8 + 8 + 4;
    Put(static_cast<uint8_t>(McapRecord::kFooter), &summary);
    Put(kFooterBytes, &summary);
    Put(begin, &summary);
    Put(offsets_begin, &summary);
    Put(Checksum(summary), &summary);
    return summary;
  }

  NewFile file_;
  std::vector<Channel> channels_;
  std::string chunk_indexes_;  // records
  uint32_t num_chunks_ = 0;
  Span whole_span_;
  // Of the chunk that is being filled:
  std::string chunk_;
  Span span_;
  std::map<size_t, std::vector<IndexEntry>> index_;
};

}  // namespace

std::unique_ptr<MessageBagWriter> NewMcap(const std::string& path) {
  return std::make_unique<McapWriter>(path);
}

}  // namespace calibrato
