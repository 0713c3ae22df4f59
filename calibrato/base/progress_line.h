#pragma once

#include <cstdint>
#include <string>

namespace calibrato {

/// What a progress bar knows at one moment.
struct ProgressState {
  std::string title;
  int64_t done = 0;
  int64_t total = 0;       ///< 0 or less: unknown, only the count is shown.
  double elapsed_s = 0.0;  ///< [s] since the first was begun
  std::string remark;
};

/// One line without a newline, cut to `width` columns (counted in bytes):
///     detecting  [=========>          ]  47 %  212/448  3 s left  rms 0.21
/// The time left assumes that the rest takes as long per item as what is done.
std::string FormatProgressLine(const ProgressState& state, size_t width);

/// "3 s", "2 min 05 s", "1 h 07 min". @param seconds  [s]; below 0 and NaN count as 0.
std::string FormatTimeSpan(double seconds);

}  // namespace calibrato
