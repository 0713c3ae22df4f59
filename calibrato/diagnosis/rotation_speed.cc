#include "calibrato/diagnosis/rotation_speed.h"

#include <algorithm>
#include <cmath>

#include "calibrato/calibration/plane_pose.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

constexpr double kMaxInterval = 0.25;  // [s]
// Beyond it a pose has flipped over: so fast a board is seen by no camera.
constexpr double kMaxSpeed = 15.0;    // [rad/s]
constexpr double kMaxOffset = 3.0;    // [s]
constexpr double kOffsetStep = 0.01;  // [s]
constexpr size_t kMinIntervals = 20;
constexpr size_t kMaxIntervals = 1000;  // Spread over the recording; more would tell no more.
constexpr double kMinStddev = 0.05;     // [rad/s]
// A peak is higher than all within so many steps: its flanks have ripples of their own.
constexpr int kPeakSteps = 10;
constexpr double kClearSigmas = 3.0;

// The angle that a gyroscope has turned by since its first sample, if it turned about one axis:
// differences over intervals are their mean speeds.
class TurnedAngle {
 public:
  explicit TurnedAngle(const std::vector<VectorSample>& gyro) : begin_(gyro.front().stamp) {
    double angle = 0.0;
    for (size_t k = 0; k < gyro.size(); ++k) {
      times_s_.push_back((gyro[k].stamp - begin_).seconds());
      if (k > 0) {
        angle += 0.5 * (gyro[k].value.norm() + gyro[k - 1].value.norm()) *
                 (times_s_[k] - times_s_[k - 1]);
      }
      angles_.push_back(angle);
    }
  }

  Time begin() const { return begin_; }
  double end_s() const { return times_s_.back(); }
  // @param t_s  Since begin(), in [0, end_s()].
  double At(double t_s) const {
    const auto after = std::upper_bound(times_s_.begin() + 1, times_s_.end() - 1, t_s);
    const auto k = static_cast<size_t>(after - times_s_.begin());
    const double share = (t_s - times_s_[k - 1]) / (times_s_[k] - times_s_[k - 1]);
    return angles_[k - 1] + share * (angles_[k] - angles_[k - 1]);
  }

 private:
  Time begin_;
  std::vector<double> times_s_;
  std::vector<double> angles_;
};

// At one offset, from so many intervals.
struct ComparisonAt {
  SpeedComparison comparison;
  double num_intervals = 0.0;
};

// Nothing with too little overlap or motion.
std::optional<ComparisonAt> CompareAt(const std::vector<RotationSpeed>& camera,
                                      const TurnedAngle& angle, double time_offset_s) {
  double n = 0.0;
  double sum_c = 0.0;
  double sum_g = 0.0;
  double sum_cc = 0.0;
  double sum_gg = 0.0;
  double sum_cg = 0.0;
  for (const RotationSpeed& interval : camera) {
    const double begin_s = (interval.begin - angle.begin()).seconds() + time_offset_s;
    const double end_s = (interval.end - angle.begin()).seconds() + time_offset_s;
    if (!(begin_s >= 0.0 && end_s <= angle.end_s())) continue;
    const double c = interval.speed;
    const double g = (angle.At(end_s) - angle.At(begin_s)) / (end_s - begin_s);
    n += 1.0;
    sum_c += c;
    sum_g += g;
    sum_cc += c * c;
    sum_gg += g * g;
    sum_cg += c * g;
  }
  const double least = std::max<double>(kMinIntervals, 0.3 * static_cast<double>(camera.size()));
  const double variance_c = (sum_cc - sum_c * sum_c / n) / n;
  const double variance_g = (sum_gg - sum_g * sum_g / n) / n;
  if (!(n >= least) || !(variance_c > kMinStddev * kMinStddev) || !(variance_g > 0.0)) {
    return std::nullopt;
  }
  const double covariance = (sum_cg - sum_c * sum_g / n) / n;
  return ComparisonAt{
      {time_offset_s, covariance / std::sqrt(variance_c * variance_g), sum_cg / sum_cc}, n};
}

// Fisher's z is normal with a variance of 1 / (n - 3), whatever the correlation.
bool IsClearlyLower(const ComparisonAt& a, const ComparisonAt& b) {
  const auto z = [](const ComparisonAt& at) {
    return std::atanh(std::clamp(at.comparison.correlation, -1.0 + 1e-9, 1.0 - 1e-9));
  };
  const double variance = 1.0 / (a.num_intervals - 3.0) + 1.0 / (b.num_intervals - 3.0);
  return z(b) - z(a) > kClearSigmas * std::sqrt(variance);
}

bool IsPeak(const std::vector<std::optional<ComparisonAt>>& comparisons, size_t k) {
  const size_t begin = k - std::min<size_t>(k, kPeakSteps);
  const size_t end = std::min(comparisons.size(), k + kPeakSteps + 1);
  for (size_t other = begin; other < end; ++other) {
    if (comparisons[other] &&
        comparisons[other]->comparison.correlation > comparisons[k]->comparison.correlation) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::vector<RotationSpeed> RotationSpeeds(const CameraModel& model,
                                          const std::vector<BoardView>& views) {
  std::vector<RotationSpeed> speeds;
  std::optional<Rigid3> before;
  Time before_stamp;
  for (const BoardView& view : views) {
    const std::optional<Rigid3> T_c_g = PoseFromView(model, view);
    if (!T_c_g) continue;
    const double elapsed_s = (view.stamp - before_stamp).seconds();
    if (before && elapsed_s > 0.0 && elapsed_s <= kMaxInterval) {
      const double speed = LogSo3(T_c_g->R * before->R.transpose()).norm() / elapsed_s;
      if (speed <= kMaxSpeed) speeds.push_back({before_stamp, view.stamp, speed});
    }
    before = T_c_g;
    before_stamp = view.stamp;
  }
  return speeds;
}

std::optional<SpeedComparison> CompareSpeeds(const std::vector<RotationSpeed>& camera,
                                             const std::vector<VectorSample>& gyro,
                                             double centre_s) {
  if (gyro.size() < 2) return std::nullopt;
  const TurnedAngle angle(gyro);
  std::vector<RotationSpeed> some;
  const size_t stride = camera.size() / kMaxIntervals + 1;
  for (size_t i = 0; i < camera.size(); i += stride) some.push_back(camera[i]);
  std::vector<std::optional<ComparisonAt>> comparisons;
  std::optional<ComparisonAt> best;
  const auto num_steps = static_cast<int>(std::lround(kMaxOffset / kOffsetStep));
  for (int step = -num_steps; step <= num_steps; ++step) {
    comparisons.push_back(CompareAt(some, angle, centre_s + step * kOffsetStep));
    const auto& here = comparisons.back();
    if (here && (!best || here->comparison.correlation > best->comparison.correlation)) best = here;
  }
  if (!best) return std::nullopt;
  SpeedComparison nearest = best->comparison;
  for (size_t k = 0; k < comparisons.size(); ++k) {
    if (!comparisons[k] || IsClearlyLower(*comparisons[k], *best) || !IsPeak(comparisons, k)) {
      continue;
    }
    const SpeedComparison& peak = comparisons[k]->comparison;
    if (std::abs(peak.time_offset_s - centre_s) < std::abs(nearest.time_offset_s - centre_s)) {
      nearest = peak;
    }
  }
  return nearest;
}

}  // namespace calibrato
