#include "calibrato/diagnosis/stream_defects.h"

#include <algorithm>
#include <cmath>

#include "calibrato/diagnosis/upper_median.h"

namespace calibrato {
namespace {

constexpr size_t kMinRepetitions = 5;
constexpr double kGapPeriods = 3.0;

// How many values of a sorted range stand at its end, if they heap up there: in a signal that turns
// round by itself, or is only rounded, the last value is not five times as frequent as the one
// before it.
template <typename Iterator>
size_t HeapedUpAtFront(Iterator begin, Iterator end) {
  const Iterator next = std::find_if(begin, end, [&](double x) { return x != *begin; });
  if (next == end) return 0;
  const auto num_first = static_cast<size_t>(next - begin);
  const auto num_second =
      static_cast<size_t>(std::find_if(next, end, [&](double x) { return x != *next; }) - next);
  return num_first >= kMinRepetitions * num_second ? num_first : 0;
}

void FindSaturation(const std::vector<VectorSample>& mended, int axis, StreamDefects* defects) {
  std::vector<double> values;
  values.reserve(mended.size());
  for (const VectorSample& sample : mended) values.push_back(sample.value(axis));
  std::sort(values.begin(), values.end());
  if (values.size() < kMinRepetitions) return;
  defects->is_constant[axis] = values.front() == values.back();
  const size_t low = HeapedUpAtFront(values.begin(), values.end());
  const size_t high = HeapedUpAtFront(values.rbegin(), values.rend());
  defects->num_saturated[axis] = low + high;
  const double lowest = low > 0 ? values.front() : 0.0;
  const double highest = high > 0 ? values.back() : 0.0;
  defects->saturated_at[axis] = std::abs(lowest) > std::abs(highest) ? lowest : highest;
}

}  // namespace

StreamDefects FindDefects(const std::vector<VectorSample>& samples) {
  StreamDefects defects;
  defects.num_samples = samples.size();
  for (size_t k = 0; k < samples.size(); ++k) {
    if (!samples[k].value.allFinite()) ++defects.num_not_finite;
    if (k > 0 && samples[k].stamp < samples[k - 1].stamp) ++defects.num_out_of_order;
  }
  const std::vector<VectorSample> mended = Mended(samples);
  defects.num_duplicates = samples.size() - defects.num_not_finite - mended.size();
  std::vector<double> periods_s;
  for (size_t k = 1; k < mended.size(); ++k) {
    periods_s.push_back((mended[k].stamp - mended[k - 1].stamp).seconds());
  }
  defects.median_period_s = UpperMedian(periods_s);
  for (size_t k = 0; k < periods_s.size(); ++k) {
    if (!(periods_s[k] > kGapPeriods * defects.median_period_s)) continue;
    ++defects.num_gaps;
    if (periods_s[k] <= defects.longest_gap_s) continue;
    defects.longest_gap_s = periods_s[k];
    defects.longest_gap_begin = mended[k].stamp;
  }
  for (int axis = 0; axis < 3; ++axis) FindSaturation(mended, axis, &defects);
  return defects;
}

std::vector<VectorSample> Mended(const std::vector<VectorSample>& samples) {
  std::vector<VectorSample> mended;
  mended.reserve(samples.size());
  for (const VectorSample& sample : samples) {
    if (sample.value.allFinite()) mended.push_back(sample);
  }
  std::stable_sort(mended.begin(), mended.end(),
                   [](const VectorSample& a, const VectorSample& b) { return a.stamp < b.stamp; });
  const auto twins =
      std::unique(mended.begin(), mended.end(),
                  [](const VectorSample& a, const VectorSample& b) { return a.stamp == b.stamp; });
  mended.erase(twins, mended.end());
  return mended;
}

ImuStream Mended(const ImuStream& stream) { return {Mended(stream.gyro), Mended(stream.accel)}; }

}  // namespace calibrato
