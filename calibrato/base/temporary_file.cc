#include "calibrato/base/temporary_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "calibrato/base/file_descriptor.h"
#include "calibrato/base/file_failure.h"
#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

int WriteAll(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = write(fd, content.data(), content.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      return errno;
    }
    content.remove_prefix(static_cast<size_t>(written));
  }
  return 0;
}

// Some file systems have no sync; that is no reason to lose the result.
int SyncIfSupported(int fd) {
  if (fsync(fd) == 0 || errno == EINVAL || errno == ENOTSUP || errno == ENOSYS) return 0;
  return errno;
}

// A new name is on disk only when its folder is. The content is there already, so a failure here is
// not worth an error.
void SyncFolder(const fs::path& folder) {
  const FileDescriptor fd(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0) static_cast<void>(SyncIfSupported(fd.get()));
}

fs::path FolderOf(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// Where a rename to `path` should go: symbolic links are followed, so that they stay links; folders
// and devices (/dev/null) are refused, since a rename would replace them.
fs::path RenameTarget(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    if (errno != ENOENT) FailFile("cannot write file", path, errno);
    return path;
  }
  if (S_ISDIR(status.st_mode)) FailFile("cannot write file", path, EISDIR);
  if (!S_ISREG(status.st_mode)) {
    throw InputError({"cannot write file", path, "it is a device or a pipe", "name a file"});
  }
  std::error_code error;
  fs::path target = fs::canonical(path, error);
  if (error) FailFile("cannot write file", path, error.value());
  return target;
}

}  // namespace

TemporaryFile::TemporaryFile(const std::string& path, std::string_view content)
    : path_(path), target_(RenameTarget(path)) {
  static std::atomic<unsigned> counter{0};
  constexpr int kMaxTries = 1000;
  FileDescriptor fd = [&] {
    for (int i = 0;; ++i) {
      temporary_ = target_;
      temporary_ += ".tmp-" + std::to_string(getpid()) + "-" + std::to_string(counter++);
      const int fd = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd >= 0) return FileDescriptor(fd);
      if (errno != EEXIST || i == kMaxTries) FailFile("cannot write file", path, errno);
    }
  }();
  int error = WriteAll(fd.get(), content);
  if (error == 0) error = SyncIfSupported(fd.get());
  const int close_error = fd.Close();
  if (error == 0) error = close_error;
  if (error != 0) {
    unlink(temporary_.c_str());
    FailFile("cannot write file", path, error);
  }
}

TemporaryFile::~TemporaryFile() {
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

TemporaryFile::TemporaryFile(TemporaryFile&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, fs::path())) {}

void TemporaryFile::Rename() {
  if (rename(temporary_.c_str(), target_.c_str()) != 0) {
    FailFile("cannot write file", path_, errno);
  }
  temporary_.clear();
  SyncFolder(FolderOf(target_));
}

void CheckFileCanBeWritten(const std::string& path) {
  if (path.empty()) {
    throw InputError({"cannot write file", "", "its name is empty", "name a file"});
  }
  const fs::path folder = FolderOf(RenameTarget(path));
  struct stat status {};
  if (stat(folder.c_str(), &status) != 0) FailFile("cannot write file", path, errno);
  if (!S_ISDIR(status.st_mode)) FailFile("cannot write file", path, ENOTDIR);
  if (access(folder.c_str(), W_OK | X_OK) != 0) FailFile("cannot write file", path, errno);
}

}  // namespace calibrato
