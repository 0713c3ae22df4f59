#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace calibrato {

/// A file that grows part by part under a temporary name beside its own, and gets its own when it
/// is complete: nobody sees a half-written recording. Private to the room.
///
///     NewFile file(path);
///     file.Append(..); file.Append(..);
///     file.Commit();  // without it, nothing is left behind
class NewFile {
 public:
  /// @throws InputError if it cannot be made.
  explicit NewFile(std::string path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Bytes appended so far.
  uint64_t size() const { return size_; }
  /// @throws InputError: disk full, and what else can happen to a disk.
  void Append(std::string_view bytes);
  /// Replaces what was appended at `offset`. @pre offset + bytes.size() <= size().
  void Replace(uint64_t offset, std::string_view bytes);
  /// @param is_synced  False does not wait for the disk: for one of thousands of small files.
  /// @throws InputError
  void Commit(bool is_synced = true);

 private:
  void Write(uint64_t offset, std::string_view bytes);
  std::string path_;
  std::string temporary_;
  int fd_ = -1;
  uint64_t size_ = 0;
};

}  // namespace calibrato
