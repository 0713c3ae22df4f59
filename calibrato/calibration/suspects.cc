#include "calibrato/calibration/suspects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <utility>

#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLargestShare = 0.1;
constexpr double kFurthestNeighbour = 0.5;       // Between neighbours [s].
constexpr double kLongestSampleInterval = 0.05;  // [s]
constexpr double kViewTimesMedian = 10.0;
constexpr double kLeastViewDeviation = 2e-3;  // [rad], about a pixel.
constexpr double kSampleTimesMedian = 6.0;    // 13 standard deviations of white noise.

// Times of measurements, and which of them are suspect.
class Neighbourhood {
 public:
  Neighbourhood(std::vector<double> times_s, double longest_interval_s)
      : times_s_(std::move(times_s)),
        longest_interval_s_(longest_interval_s),
        suspect_(times_s_.size(), false) {}

  size_t size() const { return times_s_.size(); }
  double time_s(size_t k) const { return times_s_[k]; }
  const std::vector<bool>& suspect() const { return suspect_; }
  void Suspect(size_t k) { suspect_[k] = true; }

  // The next one in a direction that is not suspect; nothing beyond a gap.
  std::optional<size_t> Next(size_t k, int direction) const {
    for (auto i = static_cast<std::ptrdiff_t>(k) + direction;
         i >= 0 && i < static_cast<std::ptrdiff_t>(size()); i += direction) {
      const auto n = static_cast<size_t>(i);
      const double interval_s = std::abs(times_s_[n] - times_s_[k]);
      // Before suspects are passed over, or a long run of them would be walked through each time.
      if (!(interval_s <= longest_interval_s_)) return std::nullopt;
      if (suspect_[n]) continue;
      if (!(interval_s > 0.0)) return std::nullopt;
      return n;
    }
    return std::nullopt;
  }

  // Two before and two after: first and last, then those next to it. (Near an end one contrast of
  // five measurements does not tell which of them is off.)
  std::optional<std::array<size_t, 4>> FourAround(size_t k) const {
    const auto before = Next(k, -1);
    const auto after = Next(k, +1);
    if (!before || !after) return std::nullopt;
    const auto first = Next(*before, -1);
    const auto last = Next(*after, +1);
    if (!first || !last) return std::nullopt;
    return std::array<size_t, 4>{*first, *before, *after, *last};
  }

  // Lagrange's cubic through four measurements, at the time of k.
  Vector3d Interpolated(const std::array<size_t, 4>& nodes, size_t k,
                        const std::function<Vector3d(size_t)>& value) const {
    Vector3d sum = Vector3d::Zero();
    for (const size_t node : nodes) {
      double weight = 1.0;
      for (const size_t other : nodes) {
        if (other == node) continue;
        weight *= (times_s_[k] - times_s_[other]) / (times_s_[node] - times_s_[other]);
      }
      sum += weight * value(node);
    }
    return sum;
  }

 private:
  std::vector<double> times_s_;
  double longest_interval_s_;
  std::vector<bool> suspect_;
};

// @param deviation_of  Of a measurement from what those around it predict; 0 where they don't.
std::vector<bool> FindSuspects(Neighbourhood* all, double times_median, double least_deviation,
                               const std::function<double(size_t)>& deviation_of) {
  const std::vector<bool> none(all->size(), false);
  if (all->size() == 0) return none;
  std::vector<double> deviations(all->size());
  for (size_t k = 0; k < deviations.size(); ++k) deviations[k] = deviation_of(k);
  std::vector<double> sorted = deviations;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double threshold = std::max(least_deviation, times_median * *middle);

  // The worst first; of equals the earlier one.
  std::set<std::pair<double, size_t>> candidates;
  for (size_t k = 0; k < deviations.size(); ++k) {
    if (deviations[k] > threshold) candidates.emplace(-deviations[k], k);
  }
  const auto most = static_cast<size_t>(kLargestShare * static_cast<double>(all->size()));
  for (size_t num_suspects = 0; !candidates.empty(); ++num_suspects) {
    if (num_suspects == most) return none;
    const size_t worst = candidates.begin()->second;
    candidates.erase(candidates.begin());
    all->Suspect(worst);
    // Those that it had helped to predict.
    for (const int direction : {-1, +1}) {
      auto near = all->Next(worst, direction);
      for (int i = 0; i < 2 && near; ++i) {
        const bool was_candidate = candidates.erase({-deviations[*near], *near}) > 0;
        deviations[*near] = deviation_of(*near);
        if (was_candidate && deviations[*near] > threshold) {
          candidates.emplace(-deviations[*near], *near);
        }
        near = all->Next(*near, direction);
      }
    }
  }
  return all->suspect();
}

}  // namespace

std::vector<bool> FindSuspectViews(const std::vector<TimedPose>& T_c_g, const Matrix3d& R_c_i,
                                   const GyroTurns& turns) {
  struct View {
    Matrix3d R_g_i;
    Vector3d p_g;   // The camera's centre.
    Matrix3d turn;  // Of the gyroscope since its first sample.
  };
  std::vector<View> views;
  std::vector<double> times_s;
  for (const TimedPose& view : T_c_g) {
    const Rigid3 T_g_c = view.pose.Inverse();
    views.push_back({T_g_c.R * R_c_i, T_g_c.t, turns.At(view.time_s)});
    times_s.push_back(view.time_s);
  }
  Neighbourhood all(std::move(times_s), kFurthestNeighbour);
  const auto deviation_of = [&](size_t v) {
    const auto four = all.FourAround(v);
    if (!four) return 0.0;
    const size_t before = (*four)[1];
    const size_t after = (*four)[2];
    const Matrix3d R_g_a0 = views[before].R_g_i * views[before].turn.transpose();
    const Vector3d missing = LogSo3((R_g_a0 * views[after].turn).transpose() * views[after].R_g_i);
    const double u =
        (all.time_s(v) - all.time_s(before)) / (all.time_s(after) - all.time_s(before));
    const Matrix3d R_g_i = R_g_a0 * views[v].turn * ExpSo3(u * missing);
    const Vector3d p_g = all.Interpolated(*four, v, [&](size_t k) { return views[k].p_g; });
    return LogSo3(R_g_i.transpose() * views[v].R_g_i).norm() +
           (p_g - views[v].p_g).norm() / T_c_g[v].pose.t.norm();
  };
  return FindSuspects(&all, kViewTimesMedian, kLeastViewDeviation, deviation_of);
}

std::vector<bool> FindSuspectSamples(const std::vector<VectorSample>& samples) {
  std::vector<double> times_s;
  for (const VectorSample& sample : samples) {
    times_s.push_back((sample.stamp - samples.front().stamp).seconds());
  }
  Neighbourhood all(std::move(times_s), kLongestSampleInterval);
  const auto value = [&](size_t k) -> Vector3d { return samples[k].value; };
  const auto deviation_of = [&](size_t k) {
    const auto four = all.FourAround(k);
    return four ? (all.Interpolated(*four, k, value) - samples[k].value).norm() : 0.0;
  };
  return FindSuspects(&all, kSampleTimesMedian, 0.0, deviation_of);
}

}  // namespace calibrato
