#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

namespace calibrato {

/// A file in memory, for readers that take a path.
class FileOfBytes {
 public:
  FileOfBytes(const uint8_t* data, size_t size) : descriptor_(memfd_create("fuzz", 0)) {
    size_t written = 0;
    while (descriptor_ >= 0 && written < size) {
      const ssize_t count = write(descriptor_, data + written, size - written);
      if (count <= 0) std::abort();
      written += static_cast<size_t>(count);
    }
    if (descriptor_ < 0) std::abort();
  }
  ~FileOfBytes() { close(descriptor_); }
  FileOfBytes(const FileOfBytes&) = delete;
  FileOfBytes& operator=(const FileOfBytes&) = delete;

  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

}  // namespace calibrato
