#pragma once

#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

/// A long series made short without hiding anything: the time is cut into equal pieces, and of each
/// that holds values its least and its largest are kept. What stands out stays to be seen.
/// @param time_s  Of each value, ascending. Values that are not finite are left out.
/// @param num_pieces  At least 1. A series of at most 2 * num_pieces values is kept as it is, each
///                    value being least and largest.
/// @return {"time_s": middles of the pieces, "low": [..], "high": [..]}, rounded to 5 digits of the
/// largest size.
[[nodiscard]] Value Envelope(const std::vector<double>& time_s, const std::vector<double>& values,
                             int num_pieces);

}  // namespace calibrato
