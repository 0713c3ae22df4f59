#include "calibrato/base/files.h"

#include <fcntl.h>
#include <fnmatch.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "calibrato/base/file_descriptor.h"
#include "calibrato/base/file_failure.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/temporary_file.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

fs::path FolderOf(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

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
