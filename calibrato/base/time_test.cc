#include "calibrato/base/time.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace calibrato {
namespace {

TEST(Duration, FromSecondsRoundsToTheNearestNanosecond) {
  EXPECT_EQ(Duration::FromSeconds(0.0073).nanoseconds(), 7'300'000);
  EXPECT_EQ(Duration::FromSeconds(1.4e-9).nanoseconds(), 1);
  EXPECT_EQ(Duration::FromSeconds(1.6e-9).nanoseconds(), 2);
  EXPECT_EQ(Duration::FromSeconds(-1.6e-9).nanoseconds(), -2);
  EXPECT_EQ(Duration::FromSeconds(0.0).nanoseconds(), 0);
}

TEST(Duration, FromSecondsKeepsEveryBitOfLargeValues) {
  EXPECT_EQ(Duration::FromSeconds(1403636579.75).nanoseconds(), 1403636579750000000);
  EXPECT_EQ(Duration::FromSeconds(9007199254.25).nanoseconds(), 9007199254250000000);
  // The product with 1e9 rounds to a multiple of 256 ns here; the sum of the parts does not.
  EXPECT_EQ(Duration::FromSeconds(1403636579.0 + 0x1p-22).nanoseconds(), 1403636579000000238);
}

TEST(Duration, FromSecondsRefusesWhatDoesNotFit) {
  EXPECT_THROW(Duration::FromSeconds(9.2e9), std::invalid_argument);
  EXPECT_THROW(Duration::FromSeconds(-9.3e9), std::invalid_argument);
  EXPECT_THROW(Duration::FromSeconds(std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
  EXPECT_THROW(Duration::FromSeconds(std::numeric_limits<double>::infinity()),
               std::invalid_argument);
  EXPECT_NO_THROW(Duration::FromSeconds(9.1999e9));
}

TEST(Time, DifferencesOfUnixTimesAreExact) {
  const Time before = Time::FromNanoseconds(1403636579763555584);
  const Time after = Time::FromNanoseconds(1403636579763555585);
  EXPECT_EQ((after - before).nanoseconds(), 1);
  EXPECT_EQ(before + Duration::FromNanoseconds(1), after);
  EXPECT_EQ(after - Duration::FromNanoseconds(1), before);
  EXPECT_LT(before, after);
}

TEST(Duration, CalculatesLikeWholeNumbers) {
  const Duration a = Duration::FromNanoseconds(5);
  const Duration b = Duration::FromNanoseconds(3);
  EXPECT_EQ((a + b).nanoseconds(), 8);
  EXPECT_EQ((b - a).nanoseconds(), -2);
  EXPECT_EQ((-a * 4).nanoseconds(), -20);
  EXPECT_DOUBLE_EQ(Duration::FromNanoseconds(2'500'000'000).seconds(), 2.5);
}

}  // namespace
}  // namespace calibrato
