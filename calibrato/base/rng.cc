#include "calibrato/base/rng.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace calibrato {
namespace {

// splitmix64 (Steele, Lea and Flood, OOPSLA 2014): a bijection of 64 bits that spreads every input
// bit over all output bits.
uint64_t SplitMix(uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

// FNV-1a, 64 bits. Weak by itself; its result goes through SplitMix.
uint64_t HashText(std::string_view text) {
  uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : text) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  }
  return hash;
}

}  // namespace

Rng::Rng(uint64_t seed) {
  state_.seed = seed;
  for (size_t i = 0; i < state_.words.size(); ++i) {
    state_.words[i] = SplitMix(seed + i * 0x9e3779b97f4a7c15U);
  }
}

Rng Rng::Stream(std::string_view purpose, uint64_t index) const {
  // Each step is a bijection of what came before, so that streams of one purpose never collide.
  return Rng(SplitMix(SplitMix(SplitMix(state_.seed) ^ HashText(purpose)) ^ index));
}

uint64_t Rng::NextBits() {
  std::array<uint64_t, 4>& s = state_.words;
  const uint64_t result = std::rotl(s[0] + s[3], 23) + s[0];
  const uint64_t shifted = s[1] << 17;
  s[2] ^= s[0];
  s[3] ^= s[1];
  s[1] ^= s[2];
  s[0] ^= s[3];
  s[2] ^= shifted;
  s[3] = std::rotl(s[3], 45);
  return result;
}

double Rng::Uniform() { return static_cast<double>(NextBits() >> 11) * 0x1p-53; }

double Rng::Uniform(double low, double high) {
  assert(low <= high);
  const double x = low + (high - low) * Uniform();
  // The sum may round up to `high`, which is not ours to give.
  return x < high ? x : std::max(low, std::nextafter(high, low));
}

uint64_t Rng::UniformIndex(uint64_t n) {
  assert(n > 0);
  // 2^64 mod n: below it lies the part that would favour small results.
  const uint64_t threshold = (0 - n) % n;
  uint64_t bits = NextBits();
  while (bits < threshold) bits = NextBits();
  return bits % n;
}

double Rng::Normal() {
  if (state_.has_spare_normal) {
    state_.has_spare_normal = false;
    return state_.spare_normal;
  }
  double u = 0.0;
  double v = 0.0;
  double square = 0.0;
  do {
    u = 2.0 * Uniform() - 1.0;
    v = 2.0 * Uniform() - 1.0;
    square = u * u + v * v;
  } while (square >= 1.0 || square == 0.0);
  const double scale = std::sqrt(-2.0 * std::log(square) / square);
  state_.spare_normal = v * scale;
  state_.has_spare_normal = true;
  return u * scale;
}

}  // namespace calibrato
