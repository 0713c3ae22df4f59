#include "calibrato/base/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace calibrato {
namespace {

// The published algorithms once more, written apart from ours.
struct ReferenceSplitMix {
  uint64_t x;
  uint64_t Next() {
    uint64_t z = (x += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
};

struct ReferenceXoshiro {
  uint64_t a, b, c, d;
  static uint64_t Rotate(uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
  uint64_t Next() {
    const uint64_t result = Rotate(a + d, 23) + a;
    const uint64_t t = b << 17;
    c ^= a;
    d ^= b;
    b ^= c;
    a ^= d;
    c ^= t;
    d = Rotate(d, 45);
    return result;
  }
};

// The largest distance between the samples' distribution and `cdf`, times sqrt(n): above 1.95 once
// in a thousand (Kolmogorov).
template <typename Cdf>
double KolmogorovStatistic(std::vector<double> samples, const Cdf& cdf) {
  std::sort(samples.begin(), samples.end());
  const auto n = static_cast<double>(samples.size());
  double distance = 0.0;
  for (size_t i = 0; i < samples.size(); ++i) {
    const double p = cdf(samples[i]);
    distance =
        std::max({distance, p - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - p});
  }
  return distance * std::sqrt(n);
}

double NormalCdf(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

TEST(Rng, GivesThePublishedNumbersOfXoshiro256PlusPlus) {
  Rng rng(0);
  Rng::State state;
  state.words = {1, 2, 3, 4};
  rng.Restore(state);
  // The first by hand: rotl(1 + 4, 23) + 1 = 5 * 2^23 + 1.
  EXPECT_EQ(rng.NextBits(), 41943041U);
  EXPECT_EQ(rng.NextBits(), 58720359U);
  EXPECT_EQ(rng.NextBits(), 3588806011781223U);
  EXPECT_EQ(rng.NextBits(), 3591011842654386U);
  EXPECT_EQ(rng.NextBits(), 9228616714210784205U);
}

TEST(Rng, IsSeededBySplitMix) {
  ReferenceSplitMix seeds{1234567};
  EXPECT_EQ(seeds.Next(), 6457827717110365317U);  // published value
  seeds.x = 1234567;
  ReferenceXoshiro reference{seeds.Next(), seeds.Next(), seeds.Next(), seeds.Next()};
  Rng rng(1234567);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(rng.NextBits(), reference.Next());
}

TEST(Rng, UniformIsUniform) {
  Rng rng(1);
  std::vector<double> samples(100000);
  for (double& x : samples) {
    x = rng.Uniform();
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
  }
  EXPECT_LT(KolmogorovStatistic(samples, [](double x) { return x; }), 1.95);
}

TEST(Rng, UniformStaysBelowItsUpperBoundEvenWhereRoundingWouldReachIt) {
  Rng rng(2);
  const double high = std::nextafter(1.0, 2.0);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(rng.Uniform(1.0, high), 1.0);
  EXPECT_EQ(rng.Uniform(3.0, 3.0), 3.0);
  for (int i = 0; i < 1000; ++i) {
    const double x = rng.Uniform(-2.0, 5.0);
    ASSERT_GE(x, -2.0);
    ASSERT_LT(x, 5.0);
  }
}

TEST(Rng, NormalIsStandardNormal) {
  Rng rng(3);
  std::vector<double> samples(200000);
  double sum = 0.0;
  double sum_squares = 0.0;
  double sum_lagged = 0.0;
  double before = 0.0;
  for (double& x : samples) {
    x = rng.Normal();
    sum += x;
    sum_squares += x * x;
    sum_lagged += x * before;
    before = x;
  }
  const auto n = static_cast<double>(samples.size());
  EXPECT_NEAR(sum / n, 0.0, 4.0 / std::sqrt(n));
  EXPECT_NEAR(sum_squares / n, 1.0, 4.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(sum_lagged / n, 0.0, 4.0 / std::sqrt(n));
  EXPECT_LT(KolmogorovStatistic(samples, NormalCdf), 1.95);
}

TEST(Rng, NormalScalesAndShifts) {
  Rng a(4);
  Rng b(4);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(a.Normal(2.0, 3.0), 2.0 + 3.0 * b.Normal());
}

TEST(Rng, UniformIndexFavoursNone) {
  Rng rng(5);
  constexpr int kDraws = 60000;
  std::vector<int> counts(6);
  for (int i = 0; i < kDraws; ++i) ++counts.at(rng.UniformIndex(6));
  double chi_square = 0.0;
  for (const int count : counts) {
    chi_square += std::pow(count - kDraws / 6, 2) / (kDraws / 6.0);
  }
  EXPECT_LT(chi_square, 20.5);  // 99.9 % of the chi-square distribution with 5 degrees of freedom
}

TEST(Rng, UniformIndexIsUnbiasedForLargeRanges) {
  // Of 3 * 2^62 values, a bare remainder of 64 bits would give the first third twice as often.
  Rng rng(6);
  const uint64_t n = uint64_t{3} << 62;
  int num_low = 0;
  for (int i = 0; i < 30000; ++i) {
    const uint64_t index = rng.UniformIndex(n);
    ASSERT_LT(index, n);
    if (index < n / 3) ++num_low;
  }
  EXPECT_NEAR(num_low, 10000, 4 * std::sqrt(30000 * 2.0 / 9.0));
  EXPECT_EQ(rng.UniformIndex(1), 0U);
}

TEST(Rng, StreamsDoNotDependOnTheAmountDrawn) {
  const Rng fresh(7);
  Rng used(7);
  for (int i = 0; i < 17; ++i) used.Normal();
  EXPECT_EQ(fresh.Stream("noise", 3).NextBits(), used.Stream("noise", 3).NextBits());
}

TEST(Rng, StreamsOfSeedPurposeAndIndexAllDiffer) {
  std::set<uint64_t> first_draws;
  size_t num_streams = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    for (const char* purpose : {"", "noise", "esion", "rig", "gir"}) {
      for (uint64_t index = 0; index < 200; ++index) {
        first_draws.insert(Rng(seed).Stream(purpose, index).NextBits());
        ++num_streams;
      }
    }
    first_draws.insert(Rng(seed).NextBits());
    ++num_streams;
  }
  EXPECT_EQ(first_draws.size(), num_streams);
}

TEST(Rng, StreamsOfNeighbouringIndicesAreUncorrelated) {
  const Rng rng(8);
  std::vector<double> firsts;
  double sum = 0.0;
  double before = 0.0;
  for (uint64_t index = 0; index < 20000; ++index) {
    const double x = rng.Stream("episode", index).Uniform();
    firsts.push_back(x);
    sum += (x - 0.5) * (before - 0.5);
    before = x;
  }
  EXPECT_LT(KolmogorovStatistic(firsts, [](double x) { return x; }), 1.95);
  EXPECT_NEAR(12.0 * sum / 20000.0, 0.0, 4.0 / std::sqrt(20000.0));
}

TEST(Rng, RestoreContinuesWithTheSameDraws) {
  Rng rng(9);
  rng.Normal();  // leaves a spare normal, which belongs to the state
  const Rng::State state = rng.state();
  std::vector<double> expected;
  for (int i = 0; i < 5; ++i) expected.push_back(rng.Normal());
  const uint64_t expected_stream = rng.Stream("x").NextBits();

  Rng restored(123);
  restored.Restore(state);
  for (const double x : expected) EXPECT_EQ(restored.Normal(), x);
  EXPECT_EQ(restored.Stream("x").NextBits(), expected_stream);
}

}  // namespace
}  // namespace calibrato
