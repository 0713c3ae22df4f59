#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "calibrato/recording/decompression.h"
#include "calibrato/recording/random_access_file.h"

namespace calibrato {

/// A part of a bag that is packed as a whole and holds many messages.
struct Chunk {
  uint64_t offset = 0;       ///< Of its packed bytes in the file.
  uint64_t packed_size = 0;  ///< [bytes]
  uint64_t size = 0;         ///< As it claims to be, unpacked [bytes].
  Compression compression = Compression::kNone;
};

/// Unpacked chunks of a file, of which the last few are kept: images that are neighbours in time
/// lie in the same ones. Several threads may ask at once. Private to the room.
class ChunkCache {
 public:
  explicit ChunkCache(std::shared_ptr<const RandomAccessFile> file) : file_(std::move(file)) {}

  /// The largest size that a chunk may claim: a hostile file must not cost more memory than a
  /// multiple of its own size [bytes].
  [[nodiscard]] uint64_t MaxChunkBytes() const;

  /// @throws Damage: not in the file, damaged, another size than claimed, or too large.
  [[nodiscard]] std::shared_ptr<const std::string> Get(const Chunk& chunk) const;

 private:
  struct Entry {
    uint64_t offset;
    std::shared_ptr<const std::string> bytes;
  };
  std::shared_ptr<const RandomAccessFile> file_;
  mutable std::mutex mutex_;
  mutable std::list<Entry> entries_;  // the last used first
  mutable uint64_t num_bytes_ = 0;
};

}  // namespace calibrato
