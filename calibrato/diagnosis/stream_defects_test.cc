#include "calibrato/diagnosis/stream_defects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace calibrato {
namespace {

// A swing that never repeats itself, 10 s at 200 Hz; whole periods of 5 ms.
std::vector<VectorSample> Swing() {
  std::vector<VectorSample> samples;
  for (int k = 0; k < 2000; ++k) {
    const double t_s = 0.005 * k;
    samples.push_back(
        {Time::FromNanoseconds(1'000'000'000 + int64_t{5'000'000} * k),
         {std::sin(1.7 * t_s), 0.5 * std::cos(2.3 * t_s), 0.1 + std::sin(0.9 * t_s)}});
  }
  return samples;
}

size_t NumSaturated(const StreamDefects& defects) {
  return defects.num_saturated[0] + defects.num_saturated[1] + defects.num_saturated[2];
}

TEST(FindDefects, OfAGoodStreamAreNone) {
  const StreamDefects defects = FindDefects(Swing());
  EXPECT_EQ(defects.num_samples, 2000U);
  EXPECT_EQ(defects.num_not_finite + defects.num_out_of_order + defects.num_duplicates, 0U);
  EXPECT_EQ(defects.num_gaps, 0U);
  EXPECT_EQ(NumSaturated(defects), 0U);
  EXPECT_NEAR(defects.median_period_s, 0.005, 1e-12);
  EXPECT_FALSE(defects.is_constant[0]);
}

TEST(FindDefects, CountsWhatIsThere) {
  std::vector<VectorSample> samples = Swing();
  samples[10].value.y() = std::numeric_limits<double>::quiet_NaN();
  samples[20].value.z() = std::numeric_limits<double>::infinity();
  std::swap(samples[100], samples[101]);
  std::swap(samples[200], samples[205]);  // Two steps back: at 201 and at 205.
  samples[300].stamp = samples[299].stamp;
  samples.erase(samples.begin() + 500, samples.begin() + 600);
  samples.erase(samples.begin() + 700, samples.begin() + 704);
  const StreamDefects defects = FindDefects(samples);
  EXPECT_EQ(defects.num_not_finite, 2U);
  EXPECT_EQ(defects.num_out_of_order, 3U);
  EXPECT_EQ(defects.num_duplicates, 1U);
  EXPECT_EQ(defects.num_gaps, 2U);
  EXPECT_NEAR(defects.longest_gap_s, 0.505, 1e-12);
  EXPECT_EQ(defects.longest_gap_begin, samples[499].stamp);
}

TEST(FindDefects, SeesTheEndOfTheRange) {
  std::vector<VectorSample> samples = Swing();
  for (VectorSample& sample : samples) {
    sample.value.x() = std::clamp(sample.value.x(), -0.9, 2.0);
    sample.value.y() = 3.0;
  }
  const StreamDefects defects = FindDefects(samples);
  const auto expected = static_cast<size_t>(
      std::count_if(samples.begin(), samples.end(),
                    [](const VectorSample& sample) { return sample.value.x() == -0.9; }));
  EXPECT_GT(expected, 100U);
  EXPECT_EQ(defects.num_saturated[0], expected);
  EXPECT_EQ(defects.saturated_at[0], -0.9);
  EXPECT_EQ(defects.num_saturated[1], 0U);
  EXPECT_TRUE(defects.is_constant[1]);
  EXPECT_EQ(defects.num_saturated[2], 0U);
}

TEST(FindDefects, RoundedSwingsAreNotSaturated) {
  std::vector<VectorSample> samples = Swing();
  for (VectorSample& sample : samples) {
    for (double& x : sample.value) x = 0.02 * std::round(50.0 * x);
  }
  EXPECT_EQ(NumSaturated(FindDefects(samples)), 0U);
}

TEST(FindDefects, ASensorAtRestIsNotSaturated) {
  std::vector<VectorSample> samples = Swing();
  for (VectorSample& sample : samples) {
    for (double& x : sample.value) x = x > 0.99 ? 1.0 : 0.0;
  }
  EXPECT_EQ(NumSaturated(FindDefects(samples)), 0U);
  EXPECT_EQ(Mended(samples).size(), samples.size());
}

TEST(Mended, LeavesOutWhatStandsAtTheEndOfTheRange) {
  std::vector<VectorSample> samples = Swing();
  for (VectorSample& sample : samples) {
    sample.value.x() = std::clamp(sample.value.x(), -0.9, 0.8);
  }
  const StreamDefects defects = FindDefects(samples);
  ASSERT_GT(defects.num_saturated[0], 100U);
  const std::vector<VectorSample> mended = Mended(samples);
  EXPECT_EQ(mended.size(), samples.size() - defects.num_saturated[0]);
  for (const VectorSample& sample : mended) {
    EXPECT_GT(sample.value.x(), -0.9);
    EXPECT_LT(sample.value.x(), 0.8);
  }
}

TEST(Mended, IsFiniteAndAscending) {
  std::vector<VectorSample> samples = Swing();
  samples[10].value.y() = std::numeric_limits<double>::quiet_NaN();
  std::swap(samples[200], samples[205]);
  samples[300].stamp = samples[299].stamp;
  const Eigen::Vector3d first_of_twins = samples[299].value;
  const std::vector<VectorSample> mended = Mended(samples);
  EXPECT_EQ(mended.size(), 1998U);
  for (size_t k = 1; k < mended.size(); ++k) {
    EXPECT_LT(mended[k - 1].stamp, mended[k].stamp);
    EXPECT_TRUE(mended[k].value.allFinite());
  }
  EXPECT_EQ(mended[298].value, first_of_twins);
  EXPECT_TRUE(Mended(std::vector<VectorSample>{}).empty());
  EXPECT_EQ(FindDefects({}).num_samples, 0U);
}

}  // namespace
}  // namespace calibrato
