#include "calibrato/learning/training_log.h"

#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"

namespace calibrato {

TrainingLog::TrainingLog(const std::string& folder, std::string lines, bool writes)
    : path_(folder + "/training.jsonl"), writes_(writes) {
  Rewind(std::move(lines));
}

void TrainingLog::Append(const std::string& json_line) {
  const std::string text = json_line + "\n";
  lines_ += text;
  if (!writes_) return;
  file_ << text << std::flush;
  if (!file_) {
    throw InputError(
        {"cannot write training log", path_, "", "free some space, then continue with --resume"});
  }
}

void TrainingLog::Rewind(std::string lines) {
  lines_ = std::move(lines);
  if (!writes_) return;
  file_.close();
  WriteFileAtomically(path_, lines_);
  file_.open(path_, std::ios::binary | std::ios::app);
}

}  // namespace calibrato
