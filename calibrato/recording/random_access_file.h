#pragma once

#include <cstdint>
#include <string>

namespace calibrato {

/// A file of which any part can be read, by several threads at once; never all of it. Private to
/// the room.
class RandomAccessFile {
 public:
  /// @throws InputError if it is missing, a folder, or unreadable.
  explicit RandomAccessFile(std::string path);
  ~RandomAccessFile();
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;

  const std::string& path() const { return path_; }
  uint64_t size() const { return size_; }  ///< When it was opened [bytes].

  /// @throws Damage if the file has no such part, InputError if the disk fails.
  [[nodiscard]] std::string Read(uint64_t offset, uint64_t count) const;

 private:
  std::string path_;
  int fd_ = -1;
  uint64_t size_ = 0;
};

}  // namespace calibrato
