#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace calibrato {

/// Samples of 16 bits as 8: the smallest of 8, 10, 12, 14 and 16 bits that holds the brightest
/// becomes 0..255, because industrial cameras store 10 or 12 bits in 16, which would be all but
/// black otherwise. Private to the room.
[[nodiscard]] std::vector<uint8_t> ScaledTo8Bits(const uint16_t* samples, size_t count);

}  // namespace calibrato
