#include "calibrato/diagnosis/finding.h"

namespace calibrato {

std::string_view VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kWarn:
      return "warn";
    case Verdict::kFail:
      return "fail";
  }
  return "";
}

Verdict VerdictOf(const std::vector<Finding>& findings) {
  Verdict verdict = Verdict::kPass;
  for (const Finding& finding : findings) {
    if (finding.severity == Severity::kFail) return Verdict::kFail;
    if (finding.severity == Severity::kWarn) verdict = Verdict::kWarn;
  }
  return verdict;
}

Value ToValue(const std::vector<Finding>& findings) {
  Value array = Value::Array();
  for (const Finding& finding : findings) {
    const char* severity = finding.severity == Severity::kInfo   ? "info"
                           : finding.severity == Severity::kWarn ? "warn"
                                                                 : "fail";
    Value value = Value::Object();
    value.Set("severity", severity).Set("what", finding.what).Set("remedy", finding.remedy);
    array.Append(std::move(value));
  }
  return array;
}

}  // namespace calibrato
