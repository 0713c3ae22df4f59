#include "calibrato/learning/training_log.h"

#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"

namespace calibrato {

TrainingLog::TrainingLog(const std::string& folder, std::string lines)
    : path_(folder + "/training.jsonl") {
  Rewind(std::move(lines));
}

void TrainingLog::Append(const Value& line) {
  const std::string text = ToJsonLine(line) + "\n";
  lines_ += text;
  file_ << text << std::flush;
  if (!file_) {
    throw InputError(
        {"cannot write training log", path_, "", "free some space, then continue with --resume"});
  }
}

void TrainingLog::Rewind(std::string lines) {
  file_.close();
  lines_ = std::move(lines);
  WriteFileAtomically(path_, lines_);
  file_.open(path_, std::ios::binary | std::ios::app);
}

}  // namespace calibrato
