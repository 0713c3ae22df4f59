#include "calibrato/calibration/rate_alignment.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Rates of hands and arms change slowly over a fiftieth of a second.
constexpr double kCoarseStep = 0.02;  // [s]
constexpr double kFineStep = 0.0025;  // [s]

// The integral of the rates from the first sample on; trapezoids.
class RateIntegral {
 public:
  explicit RateIntegral(const std::vector<RateSample>& gyro) : gyro_(gyro), sums_(gyro.size()) {
    sums_[0].setZero();
    for (size_t k = 1; k < gyro.size(); ++k) {
      sums_[k] = sums_[k - 1] +
                 0.5 * (gyro[k].time_s - gyro[k - 1].time_s) * (gyro[k].rate + gyro[k - 1].rate);
    }
  }
  bool Covers(double begin_s, double end_s) const {
    return begin_s >= gyro_.front().time_s && end_s <= gyro_.back().time_s;
  }
  // @param hint  Where the last look-up ended; look-ups in order of time are then fast.
  Vector3d At(double t_s, size_t* hint) const {
    size_t k = std::min(*hint, gyro_.size() - 2);
    while (k > 0 && gyro_[k].time_s > t_s) --k;
    while (k + 2 < gyro_.size() && gyro_[k + 1].time_s <= t_s) ++k;
    *hint = k;
    const double step = gyro_[k + 1].time_s - gyro_[k].time_s;
    const double u = step > 0.0 ? (t_s - gyro_[k].time_s) / step : 0.0;
    return (1.0 - u) * sums_[k] + u * sums_[k + 1];
  }

 private:
  const std::vector<RateSample>& gyro_;
  std::vector<Vector3d> sums_;
};

// Of a search from 0 to the end of a range.
int NumSteps(double range, double step) {
  return static_cast<int>(std::floor(range / step + 1e-9));
}

std::optional<RateAlignment> AlignAt(const std::vector<RateInterval>& intervals,
                                     const RateIntegral& integral, double offset_s) {
  Vector3d mean_c = Vector3d::Zero();
  Vector3d mean_i = Vector3d::Zero();
  Matrix3d product = Matrix3d::Zero();  // sum of rate_i rate_c'
  double square_c = 0.0;
  double square_i = 0.0;
  size_t count = 0;
  size_t begin_hint = 0;
  size_t end_hint = 0;
  for (const RateInterval& interval : intervals) {
    const double begin = interval.begin_s + offset_s;
    const double end = interval.end_s + offset_s;
    if (!integral.Covers(begin, end)) continue;
    const Vector3d rate_i =
        (integral.At(end, &end_hint) - integral.At(begin, &begin_hint)) / (end - begin);
    mean_c += interval.rate;
    mean_i += rate_i;
    product += rate_i * interval.rate.transpose();
    square_c += interval.rate.squaredNorm();
    square_i += rate_i.squaredNorm();
    ++count;
  }
  if (count < kMinRateIntervals) return std::nullopt;
  const auto n = static_cast<double>(count);
  mean_c /= n;
  mean_i /= n;
  product -= n * mean_i * mean_c.transpose();
  square_c -= n * mean_c.squaredNorm();
  square_i -= n * mean_i.squaredNorm();
  if (!(square_c > 0.0) || !(square_i > 0.0)) return std::nullopt;
  // R maximises trace(R product).
  const Eigen::JacobiSVD<Matrix3d> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixV() * svd.matrixU().transpose()).determinant() > 0.0 ? 1.0 : -1.0;
  RateAlignment alignment;
  alignment.time_offset_s = offset_s;
  alignment.R_c_i =
      svd.matrixV() * Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixU().transpose();
  alignment.gyro_bias = mean_i - alignment.R_c_i.transpose() * mean_c;
  alignment.correlation =
      svd.singularValues().dot(Vector3d(1.0, 1.0, sign)) / std::sqrt(square_c * square_i);
  return alignment;
}

}  // namespace

std::optional<RateAlignment> AlignRates(const std::vector<RateInterval>& intervals,
                                        const std::vector<RateSample>& gyro, double max_offset_s) {
  if (gyro.size() < 2) return std::nullopt;
  const RateIntegral integral(gyro);
  std::optional<RateAlignment> best;
  const auto search = [&](double centre, double range, double step) {
    const int steps = NumSteps(range, step);
    for (int k = -steps; k <= steps; ++k) {
      const auto here = AlignAt(intervals, integral, centre + k * step);
      if (here && (!best || here->correlation > best->correlation)) best = here;
    }
  };
  search(0.0, max_offset_s, kCoarseStep);
  if (!best || max_offset_s == 0.0) return best;
  search(best->time_offset_s, kCoarseStep, kFineStep);

  const double centre = best->time_offset_s;
  const auto before = AlignAt(intervals, integral, centre - kFineStep);
  const auto after = AlignAt(intervals, integral, centre + kFineStep);
  if (!before || !after) return best;
  const double bend = before->correlation - 2.0 * best->correlation + after->correlation;
  if (!(bend < 0.0)) return best;
  const double shift = 0.5 * (before->correlation - after->correlation) / bend;
  return AlignAt(intervals, integral, centre + std::clamp(shift, -1.0, 1.0) * kFineStep);
}

size_t MostCoveredIntervals(const std::vector<RateInterval>& intervals,
                            const std::vector<RateSample>& gyro, double max_offset_s) {
  if (gyro.size() < 2) return 0;
  const RateIntegral integral(gyro);
  size_t most = 0;
  const int steps = NumSteps(max_offset_s, kCoarseStep);
  for (int k = -steps; k <= steps; ++k) {
    const double offset_s = k * kCoarseStep;
    const auto num_covered =
        std::count_if(intervals.begin(), intervals.end(), [&](const RateInterval& interval) {
          return integral.Covers(interval.begin_s + offset_s, interval.end_s + offset_s);
        });
    most = std::max(most, static_cast<size_t>(num_covered));
  }
  return most;
}

}  // namespace calibrato
