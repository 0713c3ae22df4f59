#pragma once

#include <string>

namespace calibrato {

/// For tests: a new empty folder, removed with its content in the end.
class TestFolder {
 public:
  TestFolder();
  ~TestFolder();
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Writes a file, in folders made on the way. @return Its path.
  std::string Write(const std::string& name, const std::string& content) const;
  std::string WriteGzip(const std::string& name, const std::string& content) const;

 private:
  std::string path_;
};

/// The same content as a gzip file.
std::string Gzip(const std::string& content);

}  // namespace calibrato
