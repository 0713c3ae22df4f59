#include "calibrato/base/files.h"

#include <fcntl.h>
#include <fnmatch.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

struct Explanation {
  std::string why;
  std::string remedy;
};

Explanation Explain(int error) {
  switch (error) {
    case ENOSPC:
      return {"the disk is full", "free some space or choose another disk"};
    case EDQUOT:
      return {"your share of the disk is used up", "free some space or choose another disk"};
    case EFBIG:
      return {"the file would exceed the size limit", "raise the limit with 'ulimit -f'"};
    case EACCES:
    case EPERM:
      return {"no permission", "choose another path or change its permissions"};
    case EROFS:
      return {"the file system is read-only", "choose a path that can be written"};
    case ENOENT:
      return {"no such file or folder", "check the spelling of the path"};
    case ENOTDIR:
      return {"a part of the path is a file, not a folder", "check the spelling of the path"};
    case EISDIR:
      return {"it is a folder", "name a file"};
    case ENAMETOOLONG:
      return {"the name is too long", "choose a shorter one"};
    case ELOOP:
      return {"its symbolic links lead in a circle", "mend the links"};
    case EMFILE:
    case ENFILE:
      return {"too many files are open", "raise the limit with 'ulimit -n'"};
    case EIO:
      return {"the disk reports an error", "copy the data to another disk"};
    default:
      return {std::generic_category().message(error), "choose another path"};
  }
}

[[noreturn]] void FailFile(const std::string& what, const std::string& path, int error) {
  const Explanation explanation = Explain(error);
  throw InputError({what, path, explanation.why, explanation.remedy});
}

class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() {
    if (fd_ >= 0) close(fd_);
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int get() const { return fd_; }
  /// Network file systems report a full disk only here. @return 0 or an errno.
  int Close() { return close(std::exchange(fd_, -1)) == 0 ? 0 : errno; }

 private:
  int fd_;
};

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

// A written and synced file under a temporary name beside its target; gone unless renamed.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& path, std::string_view content)
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
  ~TemporaryFile() {
    if (!temporary_.empty()) unlink(temporary_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  TemporaryFile(TemporaryFile&& other) noexcept
      : path_(std::move(other.path_)),
        target_(std::move(other.target_)),
        temporary_(std::exchange(other.temporary_, fs::path())) {}
  TemporaryFile& operator=(TemporaryFile&&) = delete;

  void Rename() {
    if (rename(temporary_.c_str(), target_.c_str()) != 0) {
      FailFile("cannot write file", path_, errno);
    }
    temporary_.clear();
    SyncFolder(FolderOf(target_));
  }

 private:
  std::string path_;  // as the person wrote it, for errors
  fs::path target_;
  fs::path temporary_;
};

// Folders made on the way to a result; gone again, if empty, unless kept.
class MadeFolders {
 public:
  MadeFolders() = default;
  ~MadeFolders() {
    for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) rmdir(folder->c_str());
  }
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  void Make(const fs::path& folder) {
    struct stat status {};
    if (folder.empty() || (stat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode))) return;
    if (folder.has_parent_path() && folder.parent_path() != folder) Make(folder.parent_path());
    if (mkdir(folder.c_str(), 0777) == 0) {
      made_.push_back(folder);
      return;
    }
    const int error = errno;
    // "a/" and "a/." name a folder that the step before has made.
    if (error == EEXIST && stat(folder.c_str(), &status) == 0) {
      if (S_ISDIR(status.st_mode)) return;
      FailFile("cannot make folder", folder, ENOTDIR);
    }
    FailFile("cannot make folder", folder, error);
  }
  void Keep() { made_.clear(); }

 private:
  std::vector<fs::path> made_;
};

// `path` itself or the nearest folder above it that exists. Nothing is made to find out.
fs::path NearestExisting(const std::string& path) {
  fs::path candidate = path;
  while (true) {
    struct stat status {};
    // lstat as well: a link that leads nowhere stands in the way of a new folder.
    if (stat(candidate.c_str(), &status) == 0) return candidate;
    if (errno != ENOENT) FailFile("cannot write folder", path, errno);
    if (lstat(candidate.c_str(), &status) == 0) {
      throw InputError({"cannot write folder", path,
                        candidate.string() + " is a symbolic link that leads nowhere",
                        "remove the link or choose another path"});
    }
    candidate = FolderOf(candidate);
  }
}

[[maybe_unused]] bool StaysInside(const fs::path& name) {
  return !name.empty() && name.is_relative() &&
         std::find(name.begin(), name.end(), fs::path("..")) == name.end();
}

}  // namespace

std::string ReadFile(const std::string& path, size_t max_bytes) {
  const std::string what = "cannot read file";
  const FileDescriptor fd(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (fd.get() < 0) FailFile(what, path, errno);
  struct stat status {};
  if (fstat(fd.get(), &status) != 0) FailFile(what, path, errno);
  if (S_ISDIR(status.st_mode)) FailFile(what, path, EISDIR);
  std::string content;
  if (S_ISREG(status.st_mode)) {
    content.reserve(std::min(static_cast<size_t>(status.st_size), max_bytes));
  }
  char block[1 << 16];
  while (true) {
    const ssize_t count = read(fd.get(), block, sizeof block);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) FailFile(what, path, errno);
    if (count == 0) return content;
    if (static_cast<size_t>(count) > max_bytes - content.size()) {
      throw InputError({what, path, "it is larger than " + std::to_string(max_bytes) + " bytes",
                        "check that it is the file you meant"});
    }
    content.append(block, static_cast<size_t>(count));
  }
}

void WriteFileAtomically(const std::string& path, std::string_view content) {
  TemporaryFile(path, content).Rename();
}

std::vector<std::string> ListFiles(const std::string& folder, const std::string& glob) {
  const std::string what = "cannot list folder";
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error.value() == ENOTDIR) {
    throw InputError({what, folder, "it is a file, not a folder", "name the folder it is in"});
  }
  if (error) FailFile(what, folder, error.value());
  std::vector<std::string> names;
  while (entries != fs::directory_iterator()) {
    std::error_code status_error;
    const std::string name = entries->path().filename().string();
    if (fnmatch(glob.c_str(), name.c_str(), FNM_PERIOD) == 0 &&
        entries->is_regular_file(status_error)) {
      names.push_back(name);
    }
    entries.increment(error);
    if (error) FailFile(what, folder, error.value());
  }
  std::sort(names.begin(), names.end());
  return names;
}

OutputFolder::OutputFolder(std::string path) : path_(std::move(path)) {
  const std::string what = "cannot write folder";
  if (path_.empty()) {
    throw InputError({what, "", "its name is empty", "name a folder, for example 'result'"});
  }
  const fs::path existing = NearestExisting(path_);
  struct stat status {};
  if (stat(existing.c_str(), &status) != 0) FailFile(what, path_, errno);
  if (!S_ISDIR(status.st_mode)) {
    throw InputError({what, path_, existing.string() + " is a file, not a folder",
                      "choose another path or move the file away"});
  }
  // Tells a read-only file system to root as well, who may otherwise write anywhere.
  if (access(existing.c_str(), W_OK | X_OK) != 0) FailFile(what, path_, errno);
}

void OutputFolder::Add(const std::string& name, std::string content) {
  assert(StaysInside(name));
  files_[name] = std::move(content);
}

void OutputFolder::Remove(const std::string& name) {
  assert(StaysInside(name));
  removed_.insert(name);
}

void OutputFolder::Commit() {
  MadeFolders folders;
  folders.Make(path_);
  std::vector<TemporaryFile> written;  // destroyed before the folders that they stand in
  written.reserve(files_.size());
  for (const auto& [name, content] : files_) {
    const fs::path path = fs::path(path_) / name;
    folders.Make(path.parent_path());
    written.emplace_back(path.string(), content);
  }
  // Before the new files have their names: nothing old may stand beside them.
  for (const std::string& name : removed_) {
    const fs::path path = fs::path(path_) / name;
    if (!files_.contains(name) && unlink(path.c_str()) != 0 && errno != ENOENT) {
      FailFile("cannot remove file", path, errno);
    }
  }
  for (TemporaryFile& file : written) file.Rename();
  folders.Keep();
}

}  // namespace calibrato
