#pragma once

#include <vector>

namespace calibrato {

/// The smallest root in (0, end] of 1 + a1 s + a2 s^2 + .., from below, or infinity if there is
/// none: up to where a radial distortion grows, whose derivative this polynomial is.
/// @param coefficients  a1, a2, .. [any], finite.
[[nodiscard]] double FirstRoot(const std::vector<double>& coefficients, double end);

}  // namespace calibrato
