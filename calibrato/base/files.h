#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace calibrato {

/// The whole file. @throws InputError if it cannot be read or is larger than max_bytes.
std::string ReadFile(const std::string& path, size_t max_bytes = size_t{64} << 20);

/// Writes to a temporary name beside `path`, syncs, renames: a reader sees the old content or the
/// new, never a part. A symbolic link is followed and stays. @throws InputError (disk full, no
/// permission; a folder, device or pipe of that name), leaving the old content.
void WriteFileAtomically(const std::string& path, std::string_view content);

/// The files of a folder whose names match a glob ("left[01]*.jpg"; "*" for all), sorted by name,
/// as names without the folder. As in a shell, a leading point must be matched by one: "*" leaves
/// hidden files out. @throws InputError if the folder is missing, not a folder or unreadable.
std::vector<std::string> ListFiles(const std::string& folder, const std::string& glob = "*");

/// A command's output folder: files are collected in memory and written together, each under a
/// temporary name first, then renamed, so that a command that fails leaves nothing behind.
///
///     OutputFolder out(options.out);          // throws now, before any work, if it can't be
///     written out.Add("result.json", ToJson(result)); out.Commit();
///
/// Names may have folders of their own ("policy/dynamics.json"), made when needed.
class OutputFolder {
 public:
  /// Checks that `path` is a folder that can be written, or can be made; makes nothing yet.
  /// @throws InputError
  explicit OutputFolder(std::string path);

  void Add(const std::string& name, std::string content);
  /// Commit() takes away the file of that name, which an earlier run may have left: what this run
  /// does not write must not be taken for its result.
  void Remove(const std::string& name);
  /// Makes the folder and writes the files. An existing folder is kept: only these names are
  /// replaced or taken away. If any temporary file can't be written (disk full), all are removed,
  /// the folder as well if this call made it. @throws InputError
  void Commit();

  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::map<std::string, std::string> files_;
  std::set<std::string> removed_;
};

}  // namespace calibrato
