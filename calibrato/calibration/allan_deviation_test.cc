#include "calibrato/calibration/allan_deviation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

// Differences of neighbours 2, 0, -3: sum of squares 13, over 2 * 3. Of means of two, 2, 3, 1.5:
// the only pair without the middle one, (1 + 3) / 2 and (3 + 0) / 2, differs by -0.5.
TEST(OverlappingAllanDeviation, OfFourNumbersIsAsByHand) {
  const std::vector<double> series = {1.0, 3.0, 3.0, 0.0};
  const AllanPoint one = OverlappingAllanDeviationAt(series, 0.1, 1);
  EXPECT_NEAR(one.deviation, std::sqrt(13.0 / 6.0), 1e-14);
  EXPECT_NEAR(one.tau_s, 0.1, 1e-15);
  EXPECT_NEAR(OverlappingAllanDeviationAt(series, 0.1, 2).deviation, std::sqrt(0.25 / 2.0), 1e-14);
}

// The nine frequencies and the values that NIST SP 1065 gives for them (section 12.1).
TEST(OverlappingAllanDeviation, OfTheHandbooksNineNumbers) {
  const std::vector<double> series = {892, 809, 823, 798, 671, 644, 883, 903, 677};
  EXPECT_NEAR(OverlappingAllanDeviationAt(series, 1.0, 1).deviation, 91.22945, 5e-6);
  EXPECT_NEAR(OverlappingAllanDeviationAt(series, 1.0, 2).deviation, 85.95287, 5e-6);
}

// Its portable series of a thousand: n -> 16807 n mod 2^31 - 1 from 1234567890, over 2^31 - 1.
TEST(OverlappingAllanDeviation, OfTheHandbooksThousandNumbers) {
  std::vector<double> series;
  uint64_t n = 1234567890;
  for (int k = 0; k < 1000; ++k) {
    series.push_back(static_cast<double>(n) / 2147483647.0);
    n = 16807 * n % 2147483647;
  }
  EXPECT_NEAR(OverlappingAllanDeviationAt(series, 1.0, 1).deviation, 2.922319e-1, 5e-8);
  EXPECT_NEAR(OverlappingAllanDeviationAt(series, 1.0, 10).deviation, 9.159953e-2, 5e-9);
  EXPECT_NEAR(OverlappingAllanDeviationAt(series, 1.0, 100).deviation, 3.241343e-2, 5e-9);
}

TEST(OverlappingAllanDeviation, TakesTausUpToAQuarterOfTheSeries) {
  const auto points = OverlappingAllanDeviation(std::vector<double>(100, 1.0), 0.5, 2);
  std::vector<int64_t> counts;
  for (const AllanPoint& point : points) {
    counts.push_back(point.num_samples);
    EXPECT_EQ(point.deviation, 0.0);
  }
  EXPECT_EQ(counts, (std::vector<int64_t>{1, 2, 3, 4, 6, 8, 11, 16, 23}));
  EXPECT_TRUE(OverlappingAllanDeviation({1.0, 2.0, 3.0}, 0.5, 2).empty());
}

// sigma^2 = N^2 / tau and K^2 tau / 3 for white noise of density N and a walk of density K.
TEST(OverlappingAllanDeviation, HasTheSlopesOfWhiteNoiseAndOfAWalk) {
  Rng rng(1);
  std::vector<double> white;
  std::vector<double> walk;
  double sum = 0.0;
  for (int k = 0; k < 200'000; ++k) {
    white.push_back(3.0 * std::sqrt(100.0) * rng.Normal());
    sum += 0.2 * std::sqrt(0.01) * rng.Normal();
    walk.push_back(sum);
  }
  for (const int64_t m : {10, 100, 1000}) {
    const AllanPoint of_white = OverlappingAllanDeviationAt(white, 0.01, m);
    EXPECT_NEAR(of_white.deviation / (3.0 / std::sqrt(of_white.tau_s)), 1.0,
                4.0 / std::sqrt(2.0 * AllanDegreesOfFreedom(NoiseSlope::kWhite, 200'000, m)));
    const AllanPoint of_walk = OverlappingAllanDeviationAt(walk, 0.01, m);
    EXPECT_NEAR(
        of_walk.deviation / (0.2 * std::sqrt(of_walk.tau_s / 3.0)), 1.0,
        0.005 + 4.0 / std::sqrt(2.0 * AllanDegreesOfFreedom(NoiseSlope::kWalk, 200'000, m)));
  }
}

// The spread of the variance over many series is what the degrees of freedom promise: 2 / degrees.
TEST(AllanDegreesOfFreedom, AreThoseOfTheSpread) {
  constexpr int kSeries = 3000;
  constexpr int64_t kSize = 256;
  for (const NoiseSlope slope : {NoiseSlope::kWhite, NoiseSlope::kWalk}) {
    for (const int64_t m : {1, 8, 32}) {
      Rng rng(7);
      double sum = 0.0;
      double squares = 0.0;
      for (int s = 0; s < kSeries; ++s) {
        std::vector<double> series;
        double value = 0.0;
        for (int64_t k = 0; k < kSize; ++k) {
          value = slope == NoiseSlope::kWalk ? value + rng.Normal() : rng.Normal();
          series.push_back(value);
        }
        const double deviation = OverlappingAllanDeviationAt(series, 1.0, m).deviation;
        sum += deviation * deviation;
        squares += std::pow(deviation, 4);
      }
      const double mean = sum / kSeries;
      const double relative_variance = (squares / kSeries - mean * mean) / (mean * mean);
      // The handbook's formulas are approximations, and this is a sample.
      EXPECT_NEAR(2.0 / relative_variance / AllanDegreesOfFreedom(slope, kSize, m), 1.0, 0.25)
          << "slope " << static_cast<int>(slope) << ", m " << m;
    }
  }
}

}  // namespace
}  // namespace calibrato
