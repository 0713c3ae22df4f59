#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

// One line, whatever the parts quote from a file: control characters (a terminal's escape codes
// among them) become a space, runs of spaces one.
std::string OnOneLine(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_blank = byte <= 0x20 || byte == 0x7f;
    if (!is_blank) {
      line += c;
    } else if (!line.empty() && line.back() != ' ') {
      line += ' ';
    }
  }
  if (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

std::string Compose(const InputError::Parts& parts) {
  std::string message;
  const auto append = [&message](const char* separator, const std::string& part) {
    const std::string line = OnOneLine(part);
    if (line.empty()) return;
    if (!message.empty()) message += separator;
    message += line;
  };
  append("", parts.what);
  append(", ", parts.where);
  append(": ", parts.why);
  append("; ", parts.remedy);
  return message;
}

}  // namespace

InputError::InputError(const Parts& parts) : std::runtime_error(Compose(parts)) {}

}  // namespace calibrato
