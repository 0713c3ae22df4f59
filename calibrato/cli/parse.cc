#include "calibrato/cli/parse.h"

#include <cstdio>

#include "calibrato/base/input_error.h"
#include "calibrato/base/scalar_text.h"

namespace calibrato {

Resolution ParseResolution(const std::string& text) {
  const size_t cross = text.find('x');
  if (cross != std::string::npos) {
    const auto width = ParseWholeNumber(text.substr(0, cross));
    const auto height = ParseWholeNumber(text.substr(cross + 1));
    constexpr int64_t kMax = 100000;
    if (width && height && *width > 0 && *height > 0 && *width <= kMax && *height <= kMax) {
      return {static_cast<int>(*width), static_cast<int>(*height)};
    }
  }
  throw InputError({"bad --resolution '" + text + "'", "", "expected two whole numbers of pixels",
                    "write --resolution 640x480"});
}

Motion ReadMotion(const std::string& path) {
  std::vector<std::string> warnings;
  Motion motion = MotionFromValue(ReadYaml(path), &warnings);
  PrintWarnings(warnings);
  return motion;
}

Rig ReadRig(const std::string& path) {
  std::vector<std::string> warnings;
  Rig rig = RigFromValue(ReadYaml(path), &warnings);
  PrintWarnings(warnings);
  return rig;
}

void PrintWarnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  }
}

}  // namespace calibrato
