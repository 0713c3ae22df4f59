#include "calibrato/recording/random_access_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/byte_fields.h"

namespace calibrato {
namespace {

[[noreturn]] void Fail(const std::string& path, int error) {
  if (error == ENOENT) {
    throw InputError(
        {"cannot read file", path, "no such file or folder", "check the spelling of the path"});
  }
  throw InputError(
      {"cannot read file", path, std::generic_category().message(error), "copy it again"});
}

}  // namespace

RandomAccessFile::RandomAccessFile(std::string path) : path_(std::move(path)) {
  // Opening a pipe would wait for its writer.
  fd_ = open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd_ < 0) Fail(path_, errno);
  struct stat status {};
  const int error = fstat(fd_, &status) == 0 ? 0 : errno;
  if (error == 0 && S_ISREG(status.st_mode)) {
    size_ = static_cast<uint64_t>(status.st_size);
    return;
  }
  close(fd_);
  if (error != 0) Fail(path_, error);
  throw InputError({"cannot read file", path_, "it is no regular file", "name a file"});
}

RandomAccessFile::~RandomAccessFile() { close(fd_); }

std::string RandomAccessFile::Read(uint64_t offset, uint64_t count) const {
  if (offset > size_ || count > size_ - offset) {
    throw Damage{"it ends at byte " + std::to_string(size_) + ", before a part of " +
                 std::to_string(count) + " bytes that begins at byte " + std::to_string(offset)};
  }
  std::string bytes(count, '\0');
  size_t done = 0;
  while (done < count) {
    const ssize_t got =
        pread(fd_, bytes.data() + done, count - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) Fail(path_, errno);
    if (got == 0) throw Damage{"it became shorter while it was read"};
    done += static_cast<size_t>(got);
  }
  return bytes;
}

}  // namespace calibrato
