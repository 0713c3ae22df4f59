#include "calibrato/diagnosis/finding.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace calibrato {

std::string_view VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kWarn:
      return "warn";
    case Verdict::kInconclusive:
      return "inconclusive";
    case Verdict::kFail:
      return "fail";
  }
  return "";
}

Verdict VerdictOf(const std::vector<Finding>& findings) {
  Verdict verdict = Verdict::kPass;
  for (const Finding& finding : findings) {
    switch (finding.severity) {
      case Severity::kInfo:
        break;
      case Severity::kWarn:
        verdict = std::max(verdict, Verdict::kWarn);
        break;
      case Severity::kInconclusive:
        verdict = std::max(verdict, Verdict::kInconclusive);
        break;
      case Severity::kFail:
        return Verdict::kFail;
    }
  }
  return verdict;
}

std::string Format(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  va_list again;
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, arguments);
  va_end(arguments);
  std::string text(static_cast<size_t>(length), ' ');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  return text;
}

Value ToValue(const std::vector<Finding>& findings) {
  Value array = Value::Array();
  for (const Finding& finding : findings) {
    const char* severity = finding.severity == Severity::kInfo           ? "info"
                           : finding.severity == Severity::kWarn         ? "warn"
                           : finding.severity == Severity::kInconclusive ? "inconclusive"
                                                                         : "fail";
    Value value = Value::Object();
    value.Set("severity", severity).Set("what", finding.what).Set("remedy", finding.remedy);
    array.Append(std::move(value));
  }
  return array;
}

}  // namespace calibrato
