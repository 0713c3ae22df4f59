#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "calibrato/recording/byte_fields.h"
#include "calibrato/recording/chunk_cache.h"
#include "calibrato/recording/message_log.h"
#include "calibrato/recording/random_access_file.h"

namespace calibrato {

/// A bag whose messages stand in the file or in chunks that are packed as a whole: what ROS 1 bags
/// and MCAP files share. Private to the room.
class ChunkedLog : public MessageLog {
 public:
  void ForEach(const Visit& visit) final;
  std::string Read(const MessagePlace& place) const final;
  const std::string& path() const final { return file_->path(); }

 protected:
  /// @param what, remedy  Of the errors that say why the file can't be read.
  ChunkedLog(const std::string& path, std::string what, std::string remedy);

  /// Goes through the file, calling Found for each message of a known type. @throws Damage
  virtual void ReadRecords() = 0;

  const RandomAccessFile& file() const { return *file_; }
  const std::vector<Chunk>& chunks() const { return chunks_; }
  /// Remembers a chunk for messages that are to be read again. Returns its number.
  size_t Add(const Chunk& chunk);
  /// @throws Damage
  std::shared_ptr<const std::string> Unpacked(size_t chunk) const;

  /// A message directly in the file.
  static MessagePlace InFile(uint64_t offset, uint64_t size);
  /// A message in a chunk, `offset` bytes behind its beginning, unpacked. One of a chunk that is
  /// not packed is read again without the rest of the chunk.
  MessagePlace InChunk(size_t chunk, uint64_t offset, uint64_t size) const;

  void Found(const LogTopic& topic, const MessagePlace& place, std::string_view bytes) const {
    if (!topic.type.empty()) (*visit_)(topic, place, bytes);
  }

 private:
  [[noreturn]] void Fail(const Damage& damage) const;

  std::shared_ptr<const RandomAccessFile> file_;
  ChunkCache cache_;
  std::vector<Chunk> chunks_;
  const Visit* visit_ = nullptr;
  std::string what_;
  std::string remedy_;
};

}  // namespace calibrato
