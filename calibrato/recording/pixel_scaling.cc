#include "calibrato/recording/pixel_scaling.h"

#include <algorithm>

namespace calibrato {
namespace {

uint32_t FullScale(uint16_t brightest) {
  for (const int bits : {8, 10, 12, 14}) {
    const uint32_t full = (uint32_t{1} << bits) - 1;
    if (brightest <= full) return full;
  }
  return 65535;
}

}  // namespace

std::vector<uint8_t> ScaledTo8Bits(const uint16_t* samples, size_t count) {
  const uint32_t full = FullScale(count == 0 ? 0 : *std::max_element(samples, samples + count));
  std::vector<uint8_t> pixels(count);
  std::transform(samples, samples + count, pixels.begin(), [full](uint32_t value) {
    return static_cast<uint8_t>((value * 255 + full / 2) / full);
  });
  return pixels;
}

}  // namespace calibrato
