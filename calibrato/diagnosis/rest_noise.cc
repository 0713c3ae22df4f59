#include "calibrato/diagnosis/rest_noise.h"

#include <algorithm>
#include <cmath>

#include "calibrato/diagnosis/upper_median.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;
using Samples = std::vector<VectorSample>;

constexpr double kSpan = 0.1;      // [s]
constexpr double kMinRest = 1.0;   // [s]
constexpr size_t kMinSamples = 5;  // In a span.
// Means of spans differ by more in one of a few thousand.
constexpr double kSigmas = 5.0;
constexpr double kLeastRate = 1e-3;   // [rad/s]
constexpr double kLeastForce = 1e-2;  // [m/s^2]
constexpr double kTooNoisy = 3.0;     // Over what is stated.

// Samples of one sensor in one span of time.
struct Span {
  Vector3d mean = Vector3d::Zero();
  Vector3d squared_differences = Vector3d::Zero();  // Sum, of neighbours.
  size_t count = 0;
};

std::vector<Span> SpansOf(const Samples& samples, Time begin, size_t num_spans) {
  std::vector<Span> spans(num_spans);
  const VectorSample* before = nullptr;
  for (const VectorSample& sample : samples) {
    const double since = (sample.stamp - begin).seconds() / kSpan;
    if (!(since >= 0.0)) continue;
    const auto k = static_cast<size_t>(since);
    if (k >= num_spans) break;
    Span& span = spans[k];
    span.mean += sample.value;
    if (before != nullptr) {
      span.squared_differences += (sample.value - before->value).cwiseAbs2();
    }
    ++span.count;
    before = &sample;
  }
  for (Span& span : spans) span.mean /= static_cast<double>(std::max<size_t>(1, span.count));
  return spans;
}

// The variance of one sample, by the quietest tenth of the spans: while a rig moves, neighbours
// differ by its motion too.
double QuietVariance(const std::vector<Span>& spans) {
  std::vector<double> variances;
  for (const Span& span : spans) {
    if (span.count >= kMinSamples) {
      variances.push_back(span.squared_differences.sum() / (6.0 * static_cast<double>(span.count)));
    }
  }
  if (variances.empty()) return 0.0;
  std::sort(variances.begin(), variances.end());
  return variances[variances.size() / 10];
}

double RateOf(const Samples& samples) {
  std::vector<double> periods_s;
  for (size_t k = 1; k < samples.size(); ++k) {
    periods_s.push_back((samples[k].stamp - samples[k - 1].stamp).seconds());
  }
  const double period_s = UpperMedian(std::move(periods_s));
  return period_s > 0.0 ? 1.0 / period_s : 0.0;
}

// A run of spans whose means lie within a box.
class Rest {
 public:
  // False, and unchanged, if the span lies outside of it.
  bool Extend(const Span& span, double limit) {
    if (span.count < kMinSamples) return false;
    const Vector3d low = is_empty_ ? span.mean : Vector3d(low_.cwiseMin(span.mean));
    const Vector3d high = is_empty_ ? span.mean : Vector3d(high_.cwiseMax(span.mean));
    if (!((high - low).maxCoeff() <= limit)) return false;
    low_ = low;
    high_ = high;
    is_empty_ = false;
    return true;
  }

 private:
  bool is_empty_ = true;
  Vector3d low_ = Vector3d::Zero();
  Vector3d high_ = Vector3d::Zero();
};

double LimitOf(const std::vector<Span>& spans, double least) {
  size_t count = 0;
  for (const Span& span : spans) count = std::max(count, span.count);
  if (count < kMinSamples) return least;
  return std::max(least,
                  2.0 * kSigmas * std::sqrt(QuietVariance(spans) / static_cast<double>(count)));
}

// The density in spans [begin, end).
double DensityOf(const std::vector<Span>& spans, size_t begin, size_t end, double rate_hz) {
  double sum = 0.0;
  double count = 0.0;
  for (size_t k = begin; k < end; ++k) {
    sum += spans[k].squared_differences.sum();
    count += 3.0 * static_cast<double>(spans[k].count);
  }
  return std::sqrt(sum / (2.0 * count) / rate_hz);
}

}  // namespace

std::optional<RestNoise> NoiseAtRest(const ImuStream& stream) {
  if (stream.gyro.size() < 2 || stream.accel.size() < 2) return std::nullopt;
  const Time begin = std::max(stream.gyro.front().stamp, stream.accel.front().stamp);
  const Time end = std::min(stream.gyro.back().stamp, stream.accel.back().stamp);
  const double duration_s = (end - begin).seconds();
  // With pauses far longer than what was recorded, spans would be many and empty.
  const double longest_s = 10.0 * static_cast<double>(stream.gyro.size()) * kSpan;
  if (!(duration_s >= kMinRest && duration_s <= longest_s)) return std::nullopt;
  const auto num_spans = static_cast<size_t>(duration_s / kSpan);
  const std::vector<Span> gyro = SpansOf(stream.gyro, begin, num_spans);
  const std::vector<Span> accel = SpansOf(stream.accel, begin, num_spans);
  const double gyro_limit = LimitOf(gyro, kLeastRate);
  const double accel_limit = LimitOf(accel, kLeastForce);

  size_t best = 0;
  size_t best_length = 0;
  for (size_t first = 0; first < num_spans;) {
    Rest gyro_rest;
    Rest accel_rest;
    size_t last = first;
    while (last < num_spans && gyro_rest.Extend(gyro[last], gyro_limit) &&
           accel_rest.Extend(accel[last], accel_limit)) {
      ++last;
    }
    if (last - first > best_length) {
      best = first;
      best_length = last - first;
    }
    first = std::max(first + 1, last);
  }
  // Motion may begin and end within the outer spans: rest is what remains without them.
  if (best_length < 3) return std::nullopt;
  ++best;
  best_length -= 2;
  const double rest_s = kSpan * static_cast<double>(best_length);
  if (!(rest_s >= kMinRest)) return std::nullopt;
  return RestNoise{begin + Duration::FromSeconds(kSpan * static_cast<double>(best)), rest_s,
                   DensityOf(gyro, best, best + best_length, RateOf(stream.gyro)),
                   DensityOf(accel, best, best + best_length, RateOf(stream.accel))};
}

std::vector<Finding> FindingsOnRestNoise(const std::string& imu, const RestNoise& found,
                                         const ImuNoise& stated) {
  std::vector<Finding> findings;
  const auto judge = [&](const char* sensor, double density, double said, const char* key) {
    if (!(density > kTooNoisy * said)) return;
    findings.push_back(
        {Severity::kWarn,
         imu + Format(" %s: at rest its noise is %.1f times the density that is stated for it",
                      sensor, density / said),
         Format("set %s: %.2g, or find it with calibrato noise", key, density)});
  };
  judge("gyroscope", found.gyro_noise_density, stated.gyro_noise_density,
        "gyroscope_noise_density");
  judge("accelerometer", found.accel_noise_density, stated.accel_noise_density,
        "accelerometer_noise_density");
  return findings;
}

}  // namespace calibrato
