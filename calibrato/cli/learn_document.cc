#include "calibrato/cli/learn_document.h"

#include <sstream>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/evaluation/motion_drawing.h"

namespace calibrato {
namespace {

constexpr size_t kMaxLogBytes = size_t{2} << 30;

}  // namespace

Value TrainingLines(const std::string& folder) {
  const std::string path = folder + "/training.jsonl";
  std::istringstream lines(ReadFile(path, kMaxLogBytes));
  Value array = Value::Array();
  for (std::string line; std::getline(lines, line) && !lines.eof();) {
    array.Append(ParseJson(line, path));
  }
  return array;
}

Value LearnedMotionDrawing(const Motion& motion, const Rig& rig) {
  if (motion.loops.empty()) return {};
  try {
    Value drawing = MotionDrawing(MakeExecutable(motion, motion.carrier, rig), rig);
    drawing.Set("policy", "learned").Set("board_outline_b", BoardOutline(rig));
    return drawing;
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace calibrato
