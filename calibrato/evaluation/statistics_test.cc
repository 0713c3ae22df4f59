#include "calibrato/evaluation/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace calibrato {
namespace {

TEST(Statistics, MeanAndMedianByHand) {
  EXPECT_EQ(Mean({1.0, 2.0, 6.0}), 3.0);
  EXPECT_EQ(Median({6.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(Median({6.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_TRUE(std::isnan(Mean({})));
  EXPECT_TRUE(std::isnan(Median({})));
  EXPECT_TRUE(std::isnan(BootstrapMean({}, Rng(1)).low));
}

TEST(BootstrapMean, AgreesWithTheNormalInterval) {
  Rng rng(2);
  std::vector<double> values(1000);
  for (double& value : values) value = rng.Normal(5.0, 2.0);
  const Interval interval = BootstrapMean(values, Rng(3));
  const double half = 1.96 * 2.0 / std::sqrt(1000.0);
  EXPECT_NEAR(interval.low, Mean(values) - half, 0.15 * half);
  EXPECT_NEAR(interval.high, Mean(values) + half, 0.15 * half);
}

TEST(BootstrapMean, CoversTheTrueMeanInNinetyFivePercent) {
  constexpr int kNumTrials = 400;
  int covered = 0;
  for (int trial = 0; trial < kNumTrials; ++trial) {
    Rng rng = Rng(4).Stream("trial", static_cast<uint64_t>(trial));
    std::vector<double> values(50);
    for (double& value : values) value = rng.Normal();
    const Interval interval = BootstrapMean(values, rng.Stream("bootstrap"));
    covered += interval.low <= 0.0 && 0.0 <= interval.high ? 1 : 0;
  }
  // Three standard errors about 0.95, and the percentile interval is a little short at n = 50.
  EXPECT_NEAR(covered / static_cast<double>(kNumTrials), 0.945, 0.035);
}

TEST(BootstrapRatio, WhatPairsHaveInCommonCancels) {
  Rng rng(5);
  std::vector<double> numerator;
  std::vector<double> denominator;
  for (int i = 0; i < 200; ++i) {
    const double common = std::exp(rng.Normal());
    numerator.push_back(0.8 * common);
    denominator.push_back(common);
  }
  const Interval paired = BootstrapRatio(numerator, denominator, Rng(6));
  EXPECT_NEAR(paired.low, 0.8, 1e-12);
  EXPECT_NEAR(paired.high, 0.8, 1e-12);
}

TEST(Bootstrap, IsTheSameForTheSameStream) {
  const std::vector<double> values = {1.0, 4.0, 2.0, 8.0, 5.0};
  EXPECT_EQ(BootstrapMean(values, Rng(7)).low, BootstrapMean(values, Rng(7)).low);
}

}  // namespace
}  // namespace calibrato
