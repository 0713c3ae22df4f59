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
  // Where most samples stand is where the sensor rests, coarsely rounded, not the end of its range.
  const bool is_rest = 2 * num_first > static_cast<size_t>(end - begin);
  return num_first >= kMinRepetitions * num_second && !is_rest ? num_first : 0;
}

// The ends of one axis's range, where samples heap up at them.
struct RangeEnds {
  size_t num_low = 0;
  size_t num_high = 0;
  double lowest = 0.0;
  double highest = 0.0;
  bool is_constant = false;

  bool Has(double value) const {
    return (num_low > 0 && value == lowest) || (num_high > 0 && value == highest);
  }
};

RangeEnds FindRangeEnds(const std::vector<VectorSample>& samples, int axis) {
  std::vector<double> values;
  values.reserve(samples.size());
  for (const VectorSample& sample : samples) values.push_back(sample.value(axis));
  std::sort(values.begin(), values.end());
  if (values.size() < kMinRepetitions) return {};
  return {HeapedUpAtFront(values.begin(), values.end()),
          HeapedUpAtFront(values.rbegin(), values.rend()), values.front(), values.back(),
          values.front() == values.back()};
}

void FindSaturation(const std::vector<VectorSample>& samples, int axis, StreamDefects* defects) {
  const RangeEnds ends = FindRangeEnds(samples, axis);
  defects->is_constant[axis] = ends.is_constant;
  defects->num_saturated[axis] = ends.num_low + ends.num_high;
  const double lowest = ends.num_low > 0 ? ends.lowest : 0.0;
  const double highest = ends.num_high > 0 ? ends.highest : 0.0;
  defects->saturated_at[axis] = std::abs(lowest) > std::abs(highest) ? lowest : highest;
}

// Finite, ascending, of twins the first.
std::vector<VectorSample> InOrder(const std::vector<VectorSample>& samples) {
  std::vector<VectorSample> ordered;
  ordered.reserve(samples.size());
  for (const VectorSample& sample : samples) {
    if (sample.value.allFinite()) ordered.push_back(sample);
  }
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const VectorSample& a, const VectorSample& b) { return a.stamp < b.stamp; });
  const auto twins =
      std::unique(ordered.begin(), ordered.end(),
                  [](const VectorSample& a, const VectorSample& b) { return a.stamp == b.stamp; });
  ordered.erase(twins, ordered.end());
  return ordered;
}

}  // namespace

StreamDefects FindDefects(const std::vector<VectorSample>& samples) {
  StreamDefects defects;
  defects.num_samples = samples.size();
  for (size_t k = 0; k < samples.size(); ++k) {
    if (!samples[k].value.allFinite()) ++defects.num_not_finite;
    if (k > 0 && samples[k].stamp < samples[k - 1].stamp) ++defects.num_out_of_order;
  }
  const std::vector<VectorSample> mended = InOrder(samples);
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
  std::vector<VectorSample> mended = InOrder(samples);
  const std::array<RangeEnds, 3> ends = {FindRangeEnds(mended, 0), FindRangeEnds(mended, 1),
                                         FindRangeEnds(mended, 2)};
  std::erase_if(mended, [&](const VectorSample& sample) {
    return ends[0].Has(sample.value.x()) || ends[1].Has(sample.value.y()) ||
           ends[2].Has(sample.value.z());
  });
  return mended;
}

ImuStream Mended(const ImuStream& stream) { return {Mended(stream.gyro), Mended(stream.accel)}; }

}  // namespace calibrato
