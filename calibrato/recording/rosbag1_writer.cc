#include <cassert>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "calibrato/recording/byte_fields.h"
#include "calibrato/recording/message_definitions.h"
#include "calibrato/recording/message_writer.h"
#include "calibrato/recording/new_file.h"

namespace calibrato {
namespace {

// Source: the bag format of ROS, version 2.0 (wiki.ros.org/Bags/Format/2.0).
constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr size_t kBagHeaderBytes = 4096;  // with its filling, so that it can be replaced
constexpr size_t kMaxChunkBytes = size_t{768} << 10;
constexpr int64_t kNanosecondsPerSecond = 1'000'000'000;

template <typename T>
std::string Bytes(T value) {
  std::string bytes;
  Put(value, &bytes);
  return bytes;
}

std::string TimeBytes(Time time) {
  return Bytes(static_cast<uint32_t>(time.nanoseconds() / kNanosecondsPerSecond)) +
         Bytes(static_cast<uint32_t>(time.nanoseconds() % kNanosecondsPerSecond));
}

using Fields = std::vector<std::pair<std::string_view, std::string>>;

std::string HeaderBytes(const Fields& fields) {
  std::string header;
  for (const auto& [name, value] : fields) {
    PutString(std::string(name) + "=" + value, &header);
  }
  return header;
}

void PutRecord(const Fields& fields, std::string_view data, std::string* bytes) {
  PutString(HeaderBytes(fields), bytes);
  PutString(data, bytes);
}

struct Topic {
  std::string connection;  // its record
  bool is_written = false;
};

struct IndexEntry {
  Time time;
  uint32_t offset = 0;  // in the chunk
};

struct ChunkInfo {
  uint64_t position = 0;
  Time begin;
  Time end;
  std::map<size_t, uint32_t> counts;  // by topic
};

class Rosbag1Writer : public MessageBagWriter {
 public:
  explicit Rosbag1Writer(const std::string& path) : file_(path) {
    file_.Append(kMagic);
    file_.Append(BagHeader(0));
  }

  MessageEncoding encoding() const override { return MessageEncoding::kRos1; }

  size_t AddTopic(const std::string& name, const std::string& type) override {
    const MessageDefinition definition = Ros1Definition(type);
    Topic topic;
    PutRecord(
        {{"op", "\x07"}, {"conn", Bytes(static_cast<uint32_t>(topics_.size()))}, {"topic", name}},
        HeaderBytes({{"topic", name},
                     {"type", definition.name},
                     {"md5sum", definition.md5},
                     {"message_definition", definition.text}}),
        &topic.connection);
    topics_.push_back(std::move(topic));
    return topics_.size() - 1;
  }

  void Write(size_t topic, Time time, std::string_view message) override {
    if (!topics_[topic].is_written) chunk_ += topics_[topic].connection;
    topics_[topic].is_written = true;
    index_[topic].push_back({time, static_cast<uint32_t>(chunk_.size())});
    if (!info_.begin_is_set || time < info_.chunk.begin) info_.chunk.begin = time;
    if (!info_.begin_is_set || info_.chunk.end < time) info_.chunk.end = time;
    info_.begin_is_set = true;
    PutRecord(
        {{"op", "\x02"}, {"conn", Bytes(static_cast<uint32_t>(topic))}, {"time", TimeBytes(time)}},
        message, &chunk_);
    if (chunk_.size() >= kMaxChunkBytes) EndChunk();
  }

  void Close() override {
    if (!chunk_.empty()) EndChunk();
    const uint64_t index_position = file_.size();
    std::string index;
    for (const Topic& topic : topics_) {
      if (topic.is_written) index += topic.connection;
    }
    for (const ChunkInfo& chunk : chunks_) {
      std::string counts;
      for (const auto& [topic, count] : chunk.counts) {
        Put(static_cast<uint32_t>(topic), &counts);
        Put(count, &counts);
      }
      PutRecord({{"op", "\x06"},
                 {"ver", Bytes(uint32_t{1})},
                 {"chunk_pos", Bytes(chunk.position)},
                 {"start_time", TimeBytes(chunk.begin)},
                 {"end_time", TimeBytes(chunk.end)},
                 {"count", Bytes(static_cast<uint32_t>(chunk.counts.size()))}},
                counts, &index);
    }
    file_.Append(index);
    file_.Replace(kMagic.size(), BagHeader(index_position));
    file_.Commit();
  }

 private:
  std::string BagHeader(uint64_t index_position) const {
    uint32_t num_connections = 0;
    for (const Topic& topic : topics_) num_connections += topic.is_written ? 1 : 0;
    const Fields fields = {{"op", "\x03"},
                           {"index_pos", Bytes(index_position)},
                           {"conn_count", Bytes(num_connections)},
                           {"chunk_count", Bytes(static_cast<uint32_t>(chunks_.size()))}};
    std::string record;
    PutRecord(fields, std::string(kBagHeaderBytes - HeaderBytes(fields).size(), ' '), &record);
    return record;
  }

  void EndChunk() {
    info_.chunk.position = file_.size();
    std::string header;
    PutString(HeaderBytes({{"op", "\x05"},
                           {"compression", "none"},
                           {"size", Bytes(static_cast<uint32_t>(chunk_.size()))}}),
              &header);
    Put(static_cast<uint32_t>(chunk_.size()), &header);
    file_.Append(header);
    file_.Append(chunk_);
    std::string records;
    for (const auto& [topic, entries] : index_) {
      std::string places;
      for (const IndexEntry& entry : entries) {
        places += TimeBytes(entry.time);
        Put(entry.offset, &places);
      }
      const auto count = static_cast<uint32_t>(entries.size());
      PutRecord({{"op", "\x04"},
                 {"ver", Bytes(uint32_t{1})},
                 {"conn", Bytes(static_cast<uint32_t>(topic))},
                 {"count", Bytes(count)}},
                places, &records);
      info_.chunk.counts[topic] = count;
    }
    file_.Append(records);
    chunks_.push_back(std::move(info_.chunk));
    info_ = {};
    index_.clear();
    chunk_.clear();
  }

  struct OpenChunk {
    ChunkInfo chunk;
    bool begin_is_set = false;
  };

  NewFile file_;
  std::vector<Topic> topics_;
  std::vector<ChunkInfo> chunks_;
  // Of the chunk that is being filled:
  std::string chunk_;
  OpenChunk info_;
  std::map<size_t, std::vector<IndexEntry>> index_;
};

}  // namespace

std::unique_ptr<MessageBagWriter> NewRosbag1(const std::string& path) {
  return std::make_unique<Rosbag1Writer>(path);
}

}  // namespace calibrato
