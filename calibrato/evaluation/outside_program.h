#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace calibrato {

/// How a program of others came to its end.
struct ProgramEnd {
  bool is_success = false;  ///< It ended by itself with exit code 0.
  std::string why;          ///< Else: "exit code 3", "killed by signal 11", "no end after 60 s".
  double seconds = 0.0;     ///< Wall time.
};

/// Runs a program (looked for in PATH) with these words, in a folder, without a terminal; what it
/// prints goes to a file `output.txt` there. After the limit it and all its children are killed.
[[nodiscard]] ProgramEnd RunOutsideProgram(const std::vector<std::string>& words,
                                           const std::string& folder, double limit_s);

/// A folder of its own for one run, gone with it.
class ProgramFolder {
 public:
  /// @throws InputError if none can be made in the folder for temporary files.
  ProgramFolder();
  ~ProgramFolder();
  ProgramFolder(const ProgramFolder&) = delete;
  ProgramFolder& operator=(const ProgramFolder&) = delete;

  [[nodiscard]] std::string path() const { return path_.string(); }
  [[nodiscard]] std::string PathOf(const std::string& name) const {
    return (path_ / name).string();
  }

 private:
  std::filesystem::path path_;
};

}  // namespace calibrato
