#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace calibrato {

/// A written and synced file under a temporary name beside its target; gone unless renamed. Of
/// several files that belong together all are written first, then all are renamed.
class TemporaryFile {
 public:
  /// @throws InputError as WriteFileAtomically, leaving nothing.
  TemporaryFile(const std::string& path, std::string_view content);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  TemporaryFile(TemporaryFile&& other) noexcept;
  TemporaryFile& operator=(TemporaryFile&&) = delete;

  /// Takes the place of what had the name before. Once only.
  void Rename();

 private:
  std::string path_;  // as the person wrote it, for errors
  std::filesystem::path target_;
  std::filesystem::path temporary_;
};

/// Whether a file of that name can be written, as far as can be told beforehand: its folder exists
/// and lets itself be written into, and the name is not that of a folder, device or pipe.
/// @throws InputError if not
void CheckFileCanBeWritten(const std::string& path);

}  // namespace calibrato
