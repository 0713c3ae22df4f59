#include "calibrato/cli/output_files.h"

#include <filesystem>
#include <map>
#include <system_error>

#include "calibrato/base/input_error.h"
#include "calibrato/base/temporary_file.h"

namespace calibrato {
namespace {

// One spelling a file, however it was given: relative, or by a link.
std::filesystem::path OneSpelling(const std::string& path) {
  const std::filesystem::path absolute = std::filesystem::absolute(path);
  std::error_code error;
  const std::filesystem::path canonical = std::filesystem::weakly_canonical(absolute, error);
  return error ? absolute.lexically_normal() : canonical;
}

}  // namespace

void CheckOutputFiles(const std::vector<FileArgument>& outputs,
                      const std::vector<FileArgument>& inputs) {
  std::map<std::filesystem::path, std::string> options;  // of each file, by its one spelling
  for (const FileArgument& input : inputs) {
    if (!input.path.empty()) options.emplace(OneSpelling(input.path), input.option);
  }
  for (const FileArgument& output : outputs) {
    if (output.path.empty()) continue;
    CheckFileCanBeWritten(output.path);
    const auto& [taken, is_new] = options.emplace(OneSpelling(output.path), output.option);
    if (is_new) continue;
    throw InputError({"one file for two things", output.path,
                      "it is that of " + taken->second + " and that of " + output.option,
                      "give " + output.option + " a name of its own"});
  }
}

void WriteFilesTogether(const std::vector<FileToWrite>& files) {
  std::vector<TemporaryFile> written;
  written.reserve(files.size());
  for (const FileToWrite& file : files) written.emplace_back(file.path, file.content);
  for (TemporaryFile& file : written) file.Rename();
}

}  // namespace calibrato
