#include "calibrato/recording/chunked_log.h"

#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

constexpr uint64_t kInFile = UINT64_MAX;  // a place outside of every chunk

}  // namespace

ChunkedLog::ChunkedLog(const std::string& path, std::string what, std::string remedy)
    : file_(std::make_shared<const RandomAccessFile>(path)),
      cache_(file_),
      what_(std::move(what)),
      remedy_(std::move(remedy)) {}

void ChunkedLog::ForEach(const Visit& visit) {
  visit_ = &visit;
  try {
    ReadRecords();
  } catch (const Damage& damage) {
    Fail(damage);
  }
}

std::string ChunkedLog::Read(const MessagePlace& place) const {
  try {
    if (place.container == kInFile) return file_->Read(place.offset, place.size);
    return cache_.Get(chunks_.at(place.container))->substr(place.offset, place.size);
  } catch (const Damage& damage) {
    Fail(damage);
  }
}

size_t ChunkedLog::Add(const Chunk& chunk) {
  chunks_.push_back(chunk);
  return chunks_.size() - 1;
}

std::shared_ptr<const std::string> ChunkedLog::Unpacked(size_t chunk) const {
  return cache_.Get(chunks_.at(chunk));
}

MessagePlace ChunkedLog::InFile(uint64_t offset, uint64_t size) { return {kInFile, offset, size}; }

MessagePlace ChunkedLog::InChunk(size_t chunk, uint64_t offset, uint64_t size) const {
  const Chunk& it = chunks_.at(chunk);
  if (it.compression == Compression::kNone) return InFile(it.offset + offset, size);
  return {chunk, offset, size};
}

void ChunkedLog::Fail(const Damage& damage) const {
  throw InputError({what_, path(), damage.why, remedy_});
}

}  // namespace calibrato
