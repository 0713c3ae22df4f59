#pragma once

#include <algorithm>
#include <vector>

namespace calibrato {

/// The element in the middle of the sorted values, the upper one of two; 0 of none. @pre No NaN.
[[nodiscard]] inline double UpperMedian(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace calibrato
