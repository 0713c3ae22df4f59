#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

/// Inconclusive: not wrong, but not determined by the data.
enum class Severity { kInfo, kWarn, kInconclusive, kFail };

/// One thing worth saying about a result, in the words of the person who holds the camera.
struct Finding {
  Severity severity = Severity::kInfo;
  std::string what;  ///< "the board never came near the left and right edges (X covers 41 % of what
                     ///< is wanted)"
  std::string remedy;  ///< "move it across the whole width of the image"; may be empty
};

/// To be believed or not (docs/formats.md section 1).
enum class Verdict { kPass, kWarn, kInconclusive, kFail };
/// "pass", "warn", "inconclusive", "fail"
[[nodiscard]] std::string_view VerdictName(Verdict verdict);

/// The worst of the findings.
[[nodiscard]] Verdict VerdictOf(const std::vector<Finding>& findings);

/// std::printf into a string: numbers in findings.
[[nodiscard]] [[gnu::format(printf, 1, 2)]] std::string Format(const char* format, ...);

/// [{"severity", "what", "remedy"}, ..]
[[nodiscard]] Value ToValue(const std::vector<Finding>& findings);

}  // namespace calibrato
