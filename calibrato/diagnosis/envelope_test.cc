#include "calibrato/diagnosis/envelope.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace calibrato {
namespace {

TEST(Envelope, KeepsTheOneSampleThatStandsOut) {
  std::vector<double> time_s;
  std::vector<double> values;
  for (int k = 0; k < 10000; ++k) {
    time_s.push_back(0.01 * k);
    values.push_back(std::sin(0.05 * k));
  }
  values[7345] = 25.0;
  values[123] = -7.0;
  const Value envelope = Envelope(time_s, values, 100);
  const std::vector<double> time = envelope.At("time_s").AsDoubles();
  const std::vector<double> low = envelope.At("low").AsDoubles();
  const std::vector<double> high = envelope.At("high").AsDoubles();
  ASSERT_EQ(time.size(), 100u);
  EXPECT_EQ(high[73], 25.0);
  EXPECT_EQ(low[1], -7.0);
  EXPECT_NEAR(time[73], 73.5, 0.01);
  // No piece holds less than its samples.
  for (size_t i = 0; i < 100; ++i) {
    for (size_t k = 100 * i; k < 100 * (i + 1); ++k) {
      EXPECT_LE(low[i], values[k] + 1e-3);
      EXPECT_GE(high[i], values[k] - 1e-3);
    }
  }
}

TEST(Envelope, LeavesAShortSeriesAsItIsWithoutWhatIsNotFinite) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Value envelope = Envelope({0.0, 0.1, 0.2, 0.3}, {1.0, kNan, 3.0, -123.456789}, 2);
  EXPECT_EQ(envelope.At("time_s").AsDoubles(), (std::vector<double>{0.0, 0.2, 0.3}));
  EXPECT_EQ(envelope.At("low").AsDoubles(), (std::vector<double>{1.0, 3.0, -123.46}));
  EXPECT_EQ(envelope.At("high").AsDoubles(), envelope.At("low").AsDoubles());
}

TEST(Envelope, OfNothingIsEmpty) { EXPECT_EQ(Envelope({}, {}, 5).At("time_s").size(), 0u); }

}  // namespace
}  // namespace calibrato
