#include "calibrato/recording/chunk_cache.h"

#include <algorithm>

#include "calibrato/recording/byte_fields.h"

namespace calibrato {
namespace {

constexpr uint64_t kMaxBytesKept = uint64_t{16} << 20;

}  // namespace

uint64_t ChunkCache::MaxChunkBytes() const {
  constexpr uint64_t kMegabyte = uint64_t{1} << 20;
  return std::min(24 * kMegabyte + 4 * file_->size(), 1024 * kMegabyte);
}

std::shared_ptr<const std::string> ChunkCache::Get(const Chunk& chunk) const {
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const Entry& e) { return e.offset == chunk.offset; });
    if (found != entries_.end()) {
      entries_.splice(entries_.begin(), entries_, found);
      return entries_.front().bytes;
    }
  }
  if (chunk.size > MaxChunkBytes()) {
    throw Damage{"a part of " + std::to_string(chunk.packed_size) + " bytes claims to be " +
                 std::to_string(chunk.size) + " bytes unpacked"};
  }
  // Unpacked outside of the lock; two threads that need the same chunk do it twice.
  const auto bytes = std::make_shared<const std::string>(
      Decompress(chunk.compression, file_->Read(chunk.offset, chunk.packed_size), chunk.size));
  const std::lock_guard lock(mutex_);
  entries_.push_front({chunk.offset, bytes});
  num_bytes_ += bytes->size();
  while (num_bytes_ > kMaxBytesKept && entries_.size() > 1) {
    num_bytes_ -= entries_.back().bytes->size();
    entries_.pop_back();
  }
  return bytes;
}

}  // namespace calibrato
