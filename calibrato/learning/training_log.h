#pragma once

#include <fstream>
#include <string>

#include "calibrato/base/value.h"

namespace calibrato {

/// training.jsonl as it grows: seen by who watches, and complete in every checkpoint.
class TrainingLog {
 public:
  /// Begins with these lines. @throws InputError if the file can't be written.
  /// @param writes  False: no file, since another process writes it.
  TrainingLog(const std::string& folder, std::string lines, bool writes = true);

  /// @throws InputError if the disk is full.
  void Append(const Value& line) { Append(ToJsonLine(line)); }
  void Append(const std::string& json_line);
  /// Forgets all lines but these.
  void Rewind(std::string lines);

  [[nodiscard]] const std::string& lines() const { return lines_; }

 private:
  std::string path_;
  bool writes_;
  std::string lines_;
  std::ofstream file_;
};

}  // namespace calibrato
