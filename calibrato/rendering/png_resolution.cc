#include "calibrato/rendering/png_resolution.h"

#include <cassert>
#include <cstdint>

namespace calibrato {
namespace {

std::string BigEndian(uint32_t number) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>((number >> shift) & 0xFFU);
  return bytes;
}

// Of type and content of a chunk: PNG specification, annex D.
uint32_t Checksum(const std::string& bytes) {
  uint32_t checksum = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    checksum ^= static_cast<uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) {
      checksum = (checksum >> 1U) ^ ((checksum & 1U) != 0U ? 0xEDB88320U : 0U);
    }
  }
  return ~checksum;
}

}  // namespace

std::string WithResolution(const std::string& png, int pixels_per_metre) {
  constexpr size_t kBehindHeader = 8 + 4 + 4 + 13 + 4;  // the signature and the chunk IHDR
  assert(png.size() > kBehindHeader && png.compare(12, 4, "IHDR") == 0);
  const std::string number = BigEndian(static_cast<uint32_t>(pixels_per_metre));
  const std::string chunk = "pHYs" + number + number + '\x01';
  const uint32_t length = 9;
  return png.substr(0, kBehindHeader) + BigEndian(length) + chunk + BigEndian(Checksum(chunk)) +
         png.substr(kBehindHeader);
}

}  // namespace calibrato
