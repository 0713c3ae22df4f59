#include "calibrato/base/progress_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace calibrato {
namespace {

constexpr int kBarColumns = 20;

std::string Bar(double share) {
  const int filled = static_cast<int>(share * kBarColumns);
  std::string bar(kBarColumns, ' ');
  std::fill_n(bar.begin(), filled, '=');
  if (filled < kBarColumns) bar[static_cast<size_t>(filled)] = '>';
  return "[" + bar + "]";
}

}  // namespace

std::string FormatTimeSpan(double seconds) {
  if (!(seconds > 0.0)) seconds = 0.0;
  const auto whole = static_cast<long long>(std::ceil(std::min(seconds, 3.6e9)));
  char text[64];
  if (whole < 60) {
    std::snprintf(text, sizeof text, "%lld s", whole);
  } else if (whole < 3600) {
    std::snprintf(text, sizeof text, "%lld min %02lld s", whole / 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%lld h %02lld min", whole / 3600, whole % 3600 / 60);
  }
  return text;
}

std::string FormatProgressLine(const ProgressState& state, size_t width) {
  std::string line = state.title;
  if (state.total > 0) {
    const int64_t done = std::clamp<int64_t>(state.done, 0, state.total);
    const double share = static_cast<double>(done) / static_cast<double>(state.total);
    char percent[16];
    std::snprintf(percent, sizeof percent, "%3d %%", static_cast<int>(100.0 * share));
    line += "  " + Bar(share) + "  " + percent;
    line += "  " + std::to_string(done) + "/" + std::to_string(state.total);
    if (done > 0) {
      line += "  " + FormatTimeSpan(state.elapsed_s * (1.0 - share) / share) + " left";
    }
  } else {
    line += "  " + std::to_string(state.done);
  }
  if (!state.remark.empty()) line += "  " + state.remark;
  if (line.size() > width) line.resize(width);
  return line;
}

}  // namespace calibrato
