#include "calibrato/base/time.h"

#include <cmath>
#include <stdexcept>

namespace calibrato {

Duration Duration::FromSeconds(double seconds) {
  if (!(std::abs(seconds) < 9.2e9)) {
    throw std::invalid_argument("Duration::FromSeconds: |seconds| must be below 9.2e9, found " +
                                std::to_string(seconds));
  }
  // Split first: the product of a Unix time and 1e9 does not fit a double's 53 bits.
  const double whole = std::trunc(seconds);
  const double fraction = seconds - whole;
  return Duration(static_cast<int64_t>(whole) * 1'000'000'000 + std::llround(fraction * 1e9));
}

}  // namespace calibrato
