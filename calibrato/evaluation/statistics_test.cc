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
  EXPECT_TRUE(std::isnan(BootstrapMean(std::vector<double>(), Rng(1)).low));
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

TEST(BootstrapMean, CountsWhatTrainingAgainWouldChange) {
  // Three trainings that differ much, on rigs that differ little.
  Figures figures(3, std::vector<double>(100));
  Rng rng(8);
  for (size_t m = 0; m < 3; ++m) {
    for (double& value : figures[m]) value = 1.0 + static_cast<double>(m) + 0.01 * rng.Normal();
  }
  const Interval interval = BootstrapMean(figures, Rng(9));
  EXPECT_LT(interval.low, 1.4);
  EXPECT_GT(interval.high, 2.6);
  const std::vector<double> alone = figures[1];
  EXPECT_LT(BootstrapMean(alone, Rng(9)).high - BootstrapMean(alone, Rng(9)).low, 0.01);
}

TEST(PairedRatio, LeavesOutRigsOnWhichOneFailed) {
  const double nan = std::nan("");
  EXPECT_EQ(PairedRatio({{1.0, 5.0, nan}}, {{2.0, nan, 7.0}}), 0.5);
  // Of two trainings, the one that did not fail.
  EXPECT_EQ(PairedRatio({{1.0, 3.0}, {nan, 5.0}}, {{1.0, 1.0}}), 2.5);
}

TEST(PairedPermutation, TellsADifferenceFromChance) {
  Rng rng(10);
  std::vector<double> a(60);
  std::vector<double> b(60);
  std::vector<double> c(60);
  for (size_t i = 0; i < a.size(); ++i) {
    const double common = std::exp(rng.Normal());
    a[i] = common * std::exp(0.2 * rng.Normal());
    b[i] = common * std::exp(0.2 * rng.Normal());
    c[i] = 0.7 * common * std::exp(0.2 * rng.Normal());
  }
  EXPECT_GT(PairedPermutationProbability({a}, {b}, Rng(11)), 0.05);
  EXPECT_LT(PairedPermutationProbability({c}, {a}, Rng(11)), 0.001);
  EXPECT_EQ(PairedPermutationProbability({a}, {a}, Rng(11)), 1.0);
}

// Under the hypothesis that both are alike its probabilities are uniform.
TEST(PairedPermutation, RejectsWhatIsAlikeInFivePercent) {
  constexpr int kNumTrials = 200;
  int rejected = 0;
  for (int trial = 0; trial < kNumTrials; ++trial) {
    Rng rng = Rng(12).Stream("trial", static_cast<uint64_t>(trial));
    Figures a(1, std::vector<double>(20));
    Figures b = a;
    for (double& value : a[0]) value = std::exp(rng.Normal());
    for (double& value : b[0]) value = std::exp(rng.Normal());
    rejected += PairedPermutationProbability(a, b, rng.Stream("swaps")) < 0.05 ? 1 : 0;
  }
  // Binomial with 200 and 0.05: mean 10, standard deviation 3.1.
  EXPECT_GE(rejected, 1);
  EXPECT_LE(rejected, 20);
}

TEST(Holm, ByHand) {
  const std::vector<double> adjusted = HolmAdjusted({0.04, 0.01, std::nan(""), 0.03});
  EXPECT_DOUBLE_EQ(adjusted[1], 0.03);
  EXPECT_DOUBLE_EQ(adjusted[3], 0.06);
  // Never below that of a smaller one.
  EXPECT_DOUBLE_EQ(adjusted[0], 0.06);
  EXPECT_TRUE(std::isnan(adjusted[2]));
}

TEST(Consistency, HasTheTabulatedInterval) {
  // Chi-square with 100 degrees of freedom: 74.22 and 129.56 at 2.5 % and 97.5 %.
  const ConsistencyTest test = TestConsistency(std::vector<double>(25, 4.0), 4);
  EXPECT_EQ(test.mean_nees, 4.0);
  EXPECT_NEAR(test.expected.low, 74.222 / 25.0, 1e-4);
  EXPECT_NEAR(test.expected.high, 129.561 / 25.0, 1e-4);
  EXPECT_GT(test.probability, 0.9);
  EXPECT_LT(TestConsistency(std::vector<double>(25, 8.0), 4).probability, 1e-6);
  EXPECT_LT(TestConsistency(std::vector<double>(25, 2.0), 4).probability, 1e-3);
  EXPECT_TRUE(std::isnan(TestConsistency({}, 4).mean_nees));
}

TEST(Bootstrap, IsTheSameForTheSameStream) {
  const std::vector<double> values = {1.0, 4.0, 2.0, 8.0, 5.0};
  EXPECT_EQ(BootstrapMean(values, Rng(7)).low, BootstrapMean(values, Rng(7)).low);
}

}  // namespace
}  // namespace calibrato
