#pragma once

#include <string>
#include <vector>

namespace calibrato {

/// A file that a command is told to read or to write.
struct FileArgument {
  std::string option;  ///< "--out"
  std::string path;    ///< Empty: not asked for.
};

/// Before any work: each can be written, and none of them is another, or one that is read.
/// @throws InputError, one line, that names both options
void CheckOutputFiles(const std::vector<FileArgument>& outputs,
                      const std::vector<FileArgument>& inputs);

struct FileToWrite {
  std::string path;
  std::string content;
};
/// Writes all of them, or none: each has its name only once all are on the disk.
/// @throws InputError
void WriteFilesTogether(const std::vector<FileToWrite>& files);

}  // namespace calibrato
