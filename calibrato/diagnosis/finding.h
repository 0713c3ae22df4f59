#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

enum class Severity { kInfo, kWarn, kFail };

/// One thing worth saying about a result, in the words of the person who holds the camera.
struct Finding {
  Severity severity = Severity::kInfo;
  std::string what;  ///< "the board never came near the left and right edges (X covers 41 % of what
                     ///< is wanted)"
  std::string remedy;  ///< "move it across the whole width of the image"; may be empty
};

/// To be believed or not (docs/formats.md section 1).
enum class Verdict { kPass, kWarn, kFail };
[[nodiscard]] std::string_view VerdictName(Verdict verdict);  ///< "pass", "warn", "fail"

/// The worst of the findings.
[[nodiscard]] Verdict VerdictOf(const std::vector<Finding>& findings);

/// [{"severity", "what", "remedy"}, ..]
[[nodiscard]] Value ToValue(const std::vector<Finding>& findings);

}  // namespace calibrato
