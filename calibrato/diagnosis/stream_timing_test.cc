#include "calibrato/diagnosis/stream_timing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

using testing::HasSubstr;

constexpr int64_t kPeriod = 5'000'000;  // 200 Hz

std::vector<Time> Even(int count) {
  std::vector<Time> stamps;
  for (int k = 0; k < count; ++k) stamps.push_back(Time::FromNanoseconds(1'000 + k * kPeriod));
  return stamps;
}

TEST(TimingOf, OfEvenStampsIsTheirPeriodWithoutJitter) {
  const StreamTiming timing = TimingOf(Even(401));
  EXPECT_DOUBLE_EQ(timing.median_period_s, 0.005);
  EXPECT_DOUBLE_EQ(timing.duration_s, 2.0);
  EXPECT_EQ(timing.jitter_s, 0.0);
  EXPECT_EQ(timing.num_missing, 0U);
  EXPECT_TRUE(FindingsOnTiming("imu0", timing).empty());
  EXPECT_TRUE(FindingsOnMissingImages("cam0", timing).empty());
}

TEST(TimingOf, OneStampOrNoneHasNoPeriod) {
  EXPECT_EQ(TimingOf({}).num_stamps, 0U);
  EXPECT_EQ(TimingOf(Even(1)).median_period_s, 0.0);
}

// Of stamps that are each off by an independent error of sigma, periods have sqrt(2) sigma.
TEST(TimingOf, JitterIsTheSpreadOfOneStamp) {
  Rng rng(3);
  std::vector<Time> stamps = Even(4000);
  for (Time& stamp : stamps) stamp = stamp + Duration::FromSeconds(rng.Normal(0.0, 0.4e-3));
  EXPECT_NEAR(TimingOf(stamps).jitter_s, 0.4e-3, 0.02e-3);
  EXPECT_TRUE(FindingsOnTiming("imu0", TimingOf(stamps)).empty());  // 8 % of the period
}

TEST(TimingOf, JitterOfAThirdOfThePeriodIsNamed) {
  Rng rng(3);
  std::vector<Time> stamps = Even(4000);
  for (Time& stamp : stamps) stamp = stamp + Duration::FromSeconds(rng.Normal(0.0, 1.6e-3));
  const auto findings = FindingsOnTiming("imu0", TimingOf(stamps));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0].what, HasSubstr("imu0: its stamps jitter by 1."));
}

TEST(TimingOf, CountsWhatIsMissingInGaps) {
  std::vector<Time> stamps = Even(400);
  stamps.erase(stamps.begin() + 100, stamps.begin() + 110);
  const StreamTiming timing = TimingOf(stamps);
  EXPECT_EQ(timing.num_gaps, 1U);
  EXPECT_EQ(timing.num_missing, 10U);
  EXPECT_NEAR(timing.longest_gap_s, 0.055, 1e-12);
  EXPECT_EQ(timing.longest_gap_begin, Time::FromNanoseconds(1'000 + 99 * kPeriod));
  EXPECT_NEAR(timing.jitter_s, 0.0, 1e-12);
  EXPECT_THAT(FindingsOnMissingImages("cam0", timing)[0].what,
              HasSubstr("cam0: about 10 images are missing"));
}

TEST(TimingOf, CountsWhatIsMissingHereAndThere) {
  const auto without_every = [](int nth) {
    std::vector<Time> stamps;
    for (int k = 0; k < 400; ++k) {
      if (k % nth != 1) stamps.push_back(Time::FromNanoseconds(k * kPeriod));
    }
    return stamps;
  };
  const auto findings = FindingsOnMissingImages("cam0", TimingOf(without_every(4)));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0].what, HasSubstr("cam0: about 100 of 400 images are missing"));
  EXPECT_TRUE(FindingsOnMissingImages("cam0", TimingOf(without_every(50))).empty());
}

TEST(TimingOf, TellsWhatIsMissingInPauses) {
  std::vector<Time> stamps = Even(400);
  for (size_t k = 200; k < 400; ++k) stamps[k] = stamps[k] + Duration::FromSeconds(20.0);
  const StreamTiming timing = TimingOf(stamps);
  EXPECT_EQ(timing.num_missing, timing.num_missing_in_pauses);
  EXPECT_EQ(timing.num_missing, 4000U);
}

// Ten at a time: 0.1 ms apart, then a pause.
TEST(TimingOf, BurstsAreNamed) {
  std::vector<Time> stamps;
  for (int k = 0; k < 1000; ++k) {
    stamps.push_back(Time::FromNanoseconds((k / 10) * 10 * kPeriod + (k % 10) * 100'000));
  }
  const auto findings = FindingsOnTiming("imu0", TimingOf(stamps));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0].what, HasSubstr("come in bursts"));
}

TEST(TimingOf, ALongPauseIsNoBurst) {
  std::vector<Time> stamps = Even(400);
  for (size_t k = 200; k < stamps.size(); ++k) {
    stamps[k] = stamps[k] + Duration::FromSeconds(60.0);
  }
  EXPECT_FALSE(TimingOf(stamps).comes_in_bursts);
}

TEST(TimingOf, AClockThatIsSetBackIsNoSampleOutOfOrder) {
  std::vector<Time> set_back = Even(400);
  for (size_t k = 200; k < set_back.size(); ++k) {
    set_back[k] = set_back[k] - Duration::FromSeconds(0.3025);
  }
  const StreamTiming timing = TimingOf(set_back);
  ASSERT_EQ(timing.steps_back.size(), 1U);
  EXPECT_NEAR(timing.steps_back[0].step_s, 0.2975, 1e-12);  // a period less
  EXPECT_EQ(timing.steps_back[0].before, Time::FromNanoseconds(1'000 + 199 * kPeriod));
  EXPECT_EQ(FindingsOnTiming("imu0", timing)[0].severity, Severity::kFail);

  std::vector<Time> one_late = Even(400);
  std::swap(one_late[100], one_late[110]);
  EXPECT_TRUE(TimingOf(one_late).steps_back.empty());
}

}  // namespace
}  // namespace calibrato
