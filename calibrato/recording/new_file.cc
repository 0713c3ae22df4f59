#include "calibrato/recording/new_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

[[noreturn]] void Fail(const std::string& path, int error) {
  throw InputError(
      {"cannot write file", path, std::generic_category().message(error),
       error == ENOSPC ? "free some space or choose another disk" : "choose another path"});
}

}  // namespace

NewFile::NewFile(std::string path)
    : path_(std::move(path)), temporary_(path_ + ".tmp-" + std::to_string(getpid())) {
  fd_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd_ < 0) Fail(path_, errno);
}

NewFile::~NewFile() {
  if (fd_ < 0) return;
  close(fd_);
  unlink(temporary_.c_str());
}

void NewFile::Append(std::string_view bytes) {
  Write(size_, bytes);
  size_ += bytes.size();
}

void NewFile::Replace(uint64_t offset, std::string_view bytes) {
  assert(offset + bytes.size() <= size_);
  Write(offset, bytes);
}

void NewFile::Write(uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) Fail(path_, errno);
    bytes.remove_prefix(static_cast<size_t>(written));
    offset += static_cast<uint64_t>(written);
  }
}

void NewFile::Commit(bool is_synced) {
  if (is_synced && fsync(fd_) != 0) {
    // Some file systems have no sync; that is no reason to lose the recording.
    const bool has_no_sync = errno == EINVAL || errno == ENOTSUP || errno == ENOSYS;
    if (!has_no_sync) Fail(path_, errno);
  }
  if (rename(temporary_.c_str(), path_.c_str()) != 0) Fail(path_, errno);
  const int closed = close(std::exchange(fd_, -1));
  if (closed != 0) Fail(path_, errno);
}

}  // namespace calibrato
