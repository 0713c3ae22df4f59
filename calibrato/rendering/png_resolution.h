#pragma once

#include <string>

namespace calibrato {

/// A PNG with a chunk (pHYs) that says how many pixels a metre has.
/// @param png  A PNG without one.
[[nodiscard]] std::string WithResolution(const std::string& png, int pixels_per_metre);

}  // namespace calibrato
