#include "calibrato/calibration/imu_noise.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"

namespace calibrato {
namespace {

using Samples = std::vector<VectorSample>;

constexpr int kPerOctave = 4;
constexpr double kLeastDuration = 10.0;  // [s]
constexpr size_t kLeastSamples = 1000;
constexpr double kGapPeriods = 3.0;
constexpr double kMovedRate = 0.02;  // [rad/s]
constexpr double kMovedForce = 0.2;  // [m/s^2]
constexpr double kMovedSigmas = 8.0;
// Of the means over a second, over the whole log: in limits of a change. Biases drift by less.
constexpr double kMovedSlowly = 3.0;
constexpr double kTooShort = 0.15;     // Relative sigma of a figure.
constexpr double kShows = 2.0;         // In sigmas of its square.
constexpr double kOneSided95 = 1.645;  // In sigmas.
constexpr double kFlickerShows = 3.0;  // Likewise.
// Filters within sensors correlate neighbours, and no sensor is the model: the shortest means play
// no part, and no variance counts as known better than to this share.
constexpr int64_t kShortestMean = 8;
constexpr double kModelError = 0.05;
constexpr double kFlicker = 2.0 * std::numbers::ln2 / std::numbers::pi;
constexpr double kMadToSigma = 1.4826;

std::string Number(double x) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", x);
  return text;
}

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Finite, sorted by time, the first of each stamp: a stamp that is far ahead becomes a part of its
// own, and costs no other sample.
Samples InOrder(const Samples& samples) {
  Samples kept;
  kept.reserve(samples.size());
  for (const VectorSample& sample : samples) {
    if (sample.value.allFinite()) kept.push_back(sample);
  }
  std::stable_sort(kept.begin(), kept.end(),
                   [](const VectorSample& a, const VectorSample& b) { return a.stamp < b.stamp; });
  kept.erase(
      std::unique(kept.begin(), kept.end(),
                  [](const VectorSample& a, const VectorSample& b) { return a.stamp == b.stamp; }),
      kept.end());
  return kept;
}

// The longest part without gaps, [begin, end).
struct Part {
  size_t begin = 0;
  size_t end = 0;
  double period_s = 0.0;  // Mean.
};

Part LongestPart(const Samples& samples) {
  if (samples.size() < 2) return {0, samples.size(), 0.0};
  std::vector<double> periods_s;
  for (size_t k = 1; k < samples.size(); ++k) {
    periods_s.push_back((samples[k].stamp - samples[k - 1].stamp).seconds());
  }
  const double longest_s = kGapPeriods * MedianOf(periods_s);
  Part best;
  size_t begin = 0;
  for (size_t k = 1; k <= samples.size(); ++k) {
    if (k < samples.size() && periods_s[k - 1] <= longest_s) continue;
    if (k - begin > best.end - best.begin) best = {begin, k, 0.0};
    begin = k;
  }
  const double duration_s = (samples[best.end - 1].stamp - samples[best.begin].stamp).seconds();
  best.period_s = duration_s / std::max(1.0, static_cast<double>(best.end - best.begin - 1));
  return best;
}

// Refuses a sensor that was moved: its means over neighbouring seconds differ.
void RefuseMotion(const std::string& sensor, const std::vector<double>& series, double period_s,
                  double limit) {
  const auto in_second = static_cast<size_t>(std::max(1.0, std::round(1.0 / period_s)));
  std::vector<double> means;
  for (size_t k = 0; k + in_second <= series.size(); k += in_second) {
    double sum = 0.0;
    for (size_t i = k; i < k + in_second; ++i) sum += series[i];
    means.push_back(sum / static_cast<double>(in_second));
  }
  if (means.size() < 2) return;
  const auto [lowest, highest] = std::minmax_element(means.begin(), means.end());
  if (*highest - *lowest > kMovedSlowly * limit) {
    throw InputError({"the IMU was moved", sensor,
                      "its mean over a second drifts by " + Number(*highest - *lowest) +
                          " in the part that is looked at",
                      "record it lying still, on something heavy, for three hours or more"});
  }
  std::vector<double> changes;
  for (size_t k = 1; k < means.size(); ++k) changes.push_back(std::abs(means[k] - means[k - 1]));
  const double median = MedianOf(changes);
  const double most = std::max(limit, kMovedSigmas * kMadToSigma * median);
  for (size_t k = 0; k < changes.size(); ++k) {
    if (changes[k] <= most && median <= limit) continue;
    const double moved = static_cast<double>(k + 1) * static_cast<double>(in_second) * period_s;
    throw InputError({"the IMU was moved", sensor,
                      "its mean changes within a second, " + std::to_string(std::lround(moved)) +
                          " s after the beginning of the part that is looked at",
                      "record it lying still, on something heavy, for three hours or more"});
  }
}

// The Allan variance's parts: N^2, B^2, K^2, with the covariance of the first and the last.
struct VarianceFit {
  Eigen::Vector3d squared = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
};

Eigen::Vector3d RowAt(double tau_s) { return {1.0 / tau_s, kFlicker, tau_s / 3.0}; }

NoiseSlope LargestPart(const Eigen::Vector3d& squared, double tau_s) {
  Eigen::Index largest = 0;
  squared.cwiseProduct(RowAt(tau_s)).maxCoeff(&largest);
  constexpr std::array<NoiseSlope, 3> kSlopes = {NoiseSlope::kWhite, NoiseSlope::kFlicker,
                                                 NoiseSlope::kWalk};
  return kSlopes[static_cast<size_t>(largest)];
}

// The covariance, at lag l, of what a tau's differences are made of: second differences of the
// integrated noise. That of the integral itself is, but for what second differences do not see,
//     -N^2 |l| / 2 + B^2 l^2 ln|l| / (2 pi) + K^2 |l|^3 / 12,
// so that at tau_1 = tau_2 and lag 0 it is 2 tau^2 sigma^2(tau). Zero beyond tau_1 + tau_2, but for
// the part of B, which falls as 1 / l^2 from there and is cut off.
double DifferencesCovariance(const Eigen::Vector3d& squared, double tau_1, double tau_2,
                             double lag) {
  constexpr std::array<double, 3> kSecondDifference = {1.0, -2.0, 1.0};
  double sum = 0.0;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      const double l = std::abs(lag + (a - 1) * tau_1 - (b - 1) * tau_2);
      const double flicker = l > 0.0 ? l * l * std::log(l) / (2.0 * std::numbers::pi) : 0.0;
      sum += kSecondDifference[size_t(a)] * kSecondDifference[size_t(b)] *
             (-0.5 * squared(0) * l + squared(1) * flicker + squared(2) * l * l * l / 12.0);
    }
  }
  return sum;
}

// Of two values of the overlapping Allan variance, from a series of length T: with Gaussian noise
// the covariance of two squares is twice the square of the covariance. Differences begin and end
// with their middles tau from the series' ends.
double VarianceCovariance(const Eigen::Vector3d& squared, double tau_1, double tau_2,
                          double duration_s) {
  const double reach = tau_1 + tau_2;
  constexpr int kSteps = 96;
  double integral = 0.0;
  for (int k = -kSteps; k <= kSteps; ++k) {
    const double lag = reach * k / kSteps;
    // Pairs of middles that are this far apart.
    const double overlap =
        std::min(duration_s - tau_1, duration_s - tau_2 + lag) - std::max(tau_1, tau_2 + lag);
    const double covariance = DifferencesCovariance(squared, tau_1, tau_2, lag);
    integral += std::max(0.0, overlap) * covariance * covariance * reach / kSteps;
  }
  const double scale = 4.0 * tau_1 * tau_1 * tau_2 * tau_2;
  return 2.0 * integral / ((duration_s - 2.0 * tau_1) * (duration_s - 2.0 * tau_2)) / scale;
}

// Of all values that are fitted.
Eigen::MatrixXd CovarianceOf(const std::vector<AllanPoint>& points, const Eigen::Vector3d& squared,
                             double duration_s) {
  const auto num = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd covariance(num, num);
  for (Eigen::Index i = 0; i < num; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      covariance(i, j) = VarianceCovariance(squared, points[static_cast<size_t>(i)].tau_s,
                                            points[static_cast<size_t>(j)].tau_s, duration_s);
      covariance(j, i) = covariance(i, j);
    }
    const double model = RowAt(points[static_cast<size_t>(i)].tau_s).dot(squared);
    covariance(i, i) += std::pow(kModelError * model, 2);
  }
  return covariance;
}

// Least squares with some of the parts; nothing where one of them would be below zero.
std::optional<Eigen::Vector3d> SolveWith(const std::vector<int>& parts,
                                         const Eigen::MatrixX3d& rows,
                                         const Eigen::VectorXd& values) {
  Eigen::MatrixXd some(rows.rows(), static_cast<Eigen::Index>(parts.size()));
  for (size_t i = 0; i < parts.size(); ++i) {
    some.col(static_cast<Eigen::Index>(i)) = rows.col(parts[i]);
  }
  const Eigen::VectorXd solution = some.colPivHouseholderQr().solve(values);
  if (!(solution.minCoeff() >= 0.0)) return std::nullopt;
  Eigen::Vector3d all = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < parts.size(); ++i) {
    all(parts[i]) = solution(static_cast<Eigen::Index>(i));
  }
  return all;
}

// The best of several sets of parts; nothing where each has one below zero.
std::optional<Eigen::Vector3d> BestOf(const std::vector<std::vector<int>>& sets,
                                      const Eigen::MatrixX3d& rows, const Eigen::VectorXd& values) {
  std::optional<Eigen::Vector3d> best;
  for (const std::vector<int>& parts : sets) {
    const auto solution = SolveWith(parts, rows, values);
    if (!solution) continue;
    if (!best ||
        (rows * *solution - values).squaredNorm() < (rows * *best - values).squaredNorm()) {
      best = solution;
    }
  }
  return best;
}

// The fit with some of the parts. Logarithms of the values are fitted: their errors are those of
// degrees of freedom alone, while a variance that chance made small would have a weight that is
// large. Of a chi-square of d degrees over d the logarithm's mean is about -1 / d.
VarianceFit FitParts(const std::vector<std::vector<int>>& sets,
                     const std::vector<AllanPoint>& points, int64_t series_size,
                     double duration_s) {
  const auto num = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixX3d design(num, 3);
  Eigen::VectorXd measured(num);
  for (Eigen::Index i = 0; i < num; ++i) {
    design.row(i) = RowAt(points[static_cast<size_t>(i)].tau_s).transpose();
    measured(i) = std::pow(points[static_cast<size_t>(i)].deviation, 2);
  }
  // White noise at the shortest taus, a walk at the longest: the fit falls towards what there is.
  VarianceFit fit;
  fit.squared(0) = measured(0) / design(0, 0);
  fit.squared(2) = measured(num - 1) / design(num - 1, 2);
  if (sets.front().size() == 3) fit.squared(1) = measured.minCoeff() / kFlicker;
  Eigen::VectorXd model;
  Eigen::VectorXd weights(num);
  Eigen::MatrixX3d rows;
  constexpr int kRounds = 40;
  constexpr double kLargestFall = 0.25;  // In one round: logarithms are straight for so long.
  for (int round = 0; round < kRounds; ++round) {
    model = design * fit.squared;
    Eigen::VectorXd values(num);
    for (Eigen::Index i = 0; i < num; ++i) {
      const AllanPoint& point = points[static_cast<size_t>(i)];
      const double degrees = AllanDegreesOfFreedom(LargestPart(fit.squared, point.tau_s),
                                                   series_size, point.num_samples);
      weights(i) = 1.0 / std::sqrt(2.0 / degrees + kModelError * kModelError);
      values(i) = weights(i) * (std::log(measured(i) / model(i)) + 1.0 / degrees + 1.0);
    }
    rows = (weights.cwiseQuotient(model)).asDiagonal() * design;
    const auto best = BestOf(sets, rows, values);
    if (!best) break;
    fit.squared = best->cwiseMax(kLargestFall * fit.squared);
  }
  // The parts that none of the sets has.
  std::array<bool, 3> is_held = {true, true, true};
  for (const std::vector<int>& parts : sets) {
    for (const int part : parts) is_held[static_cast<size_t>(part)] = false;
  }
  for (Eigen::Index part = 0; part < 3; ++part) {
    if (is_held[static_cast<size_t>(part)]) rows.col(part).setZero();
  }
  const Eigen::Vector3d scale =
      rows.colwise().norm().transpose().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
  Eigen::Matrix3d information = scale.asDiagonal() * (rows.transpose() * rows) * scale.asDiagonal();
  for (Eigen::Index part = 0; part < 3; ++part) {
    if (is_held[static_cast<size_t>(part)]) information(part, part) = 1.0;
  }
  const Eigen::Matrix3d inverse = information.inverse();
  const Eigen::MatrixXd estimator = scale.asDiagonal() * inverse * scale.asDiagonal() *
                                    rows.transpose() * weights.cwiseQuotient(model).asDiagonal();
  const Eigen::MatrixXd covariance = CovarianceOf(points, fit.squared, duration_s);
  fit.sigma = (estimator * covariance * estimator.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
  return fit;
}

VarianceFit FitVariance(const std::vector<AllanPoint>& points, int64_t series_size,
                        double duration_s) {
  const VarianceFit with_flicker =
      FitParts({{0, 1, 2}, {0, 1}, {1, 2}, {0, 2}, {0}, {1}, {2}}, points, series_size, duration_s);
  if (with_flicker.squared(1) > kFlickerShows * with_flicker.sigma(1)) return with_flicker;
  VarianceFit fit = FitParts({{0, 2}, {0}, {2}}, points, series_size, duration_s);
  fit.squared(1) = 0.0;
  fit.sigma(1) = 0.0;
  return fit;
}

// From a square and the sigma of the square.
NoiseFigure FigureOf(double squared, double sigma) {
  if (squared < kShows * sigma) {
    return {std::sqrt(squared + kOneSided95 * sigma), 1.0, true};
  }
  return {std::sqrt(squared), 0.5 * sigma / squared, false};
}

struct AxisResult {
  AxisNoise noise;
  VarianceFit fit;
};

AxisResult EstimateAxis(const std::vector<double>& series, double period_s) {
  AxisResult result;
  const auto size = static_cast<int64_t>(series.size());
  result.noise.points = OverlappingAllanDeviation(series, period_s, kPerOctave);
  std::vector<AllanPoint> octaves;
  for (const AllanPoint& point : result.noise.points) {
    const bool is_octave = (point.num_samples & (point.num_samples - 1)) == 0;
    if (is_octave && point.num_samples >= kShortestMean) octaves.push_back(point);
  }
  result.fit = FitVariance(octaves, size, period_s * static_cast<double>(size));
  result.noise.white = FigureOf(result.fit.squared(0), result.fit.sigma(0));
  result.noise.walk = FigureOf(result.fit.squared(2), result.fit.sigma(2));
  result.noise.bias_instability = std::sqrt(result.fit.squared(1));
  for (const AllanPoint& point : result.noise.points) {
    const double degrees = AllanDegreesOfFreedom(LargestPart(result.fit.squared, point.tau_s), size,
                                                 point.num_samples);
    result.noise.relative_sigma.push_back(1.0 / std::sqrt(2.0 * degrees));
  }
  return result;
}

SensorNoiseEstimate EstimateSensor(const std::string& name, const Samples& recorded,
                                   double moved_limit, std::vector<std::string>* warnings) {
  const Samples samples = InOrder(recorded);
  const Part part = LongestPart(samples);
  SensorNoiseEstimate estimate;
  const size_t size = part.end - part.begin;
  estimate.duration_s = part.period_s * static_cast<double>(size);
  if (size < kLeastSamples || !(estimate.duration_s >= kLeastDuration)) {
    throw InputError({"too short a log", name,
                      "its longest part without a gap has " + std::to_string(size) +
                          " samples in " + Number(estimate.duration_s) + " s",
                      "record the IMU lying still for three hours or more"});
  }
  estimate.rate_hz = 1.0 / part.period_s;
  if (2 * size < samples.size()) {
    warnings->push_back(name + ": gaps leave only " + std::to_string(size) + " of " +
                        std::to_string(samples.size()) + " samples in one piece");
  }
  const std::vector<AxisResult> axes = ParallelMap<AxisResult>(3, [&](size_t axis) {
    std::vector<double> series;
    series.reserve(size);
    for (size_t k = part.begin; k < part.end; ++k) {
      series.push_back(samples[k].value(static_cast<Eigen::Index>(axis)));
    }
    if (std::all_of(series.begin(), series.end(), [&](double x) { return x == series[0]; })) {
      throw InputError({"a sensor that never changes", name,
                        std::string("axis ") + "xyz"[axis] + " reads the same all the time",
                        "check the driver, and the columns of the file"});
    }
    RefuseMotion(name, series, part.period_s, moved_limit);
    return EstimateAxis(series, part.period_s);
  });
  Eigen::Vector3d squared = Eigen::Vector3d::Zero();
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  for (const AxisResult& axis : axes) {
    squared += axis.fit.squared / 3.0;
    variance += axis.fit.sigma.cwiseAbs2() / 9.0;
    estimate.axes.push_back(axis.noise);
  }
  estimate.white = FigureOf(squared(0), std::sqrt(variance(0)));
  estimate.walk = FigureOf(squared(2), std::sqrt(variance(2)));
  for (const auto& [figure, what] : {std::pair(&estimate.white, "white noise"),
                                     std::pair(&estimate.walk, "random walk of the bias")}) {
    if (figure->is_upper_bound) {
      warnings->push_back(name + ": the log of " + Number(estimate.duration_s) +
                          " s is too short to show its " + what +
                          "; what is written is an upper bound (95 %)");
    } else if (figure->relative_sigma > kTooShort) {
      warnings->push_back(name + ": the log of " + Number(estimate.duration_s) + " s tells its " +
                          what + " to " + Number(100.0 * figure->relative_sigma) +
                          " % only (one sigma); record for longer");
    }
  }
  return estimate;
}

}  // namespace

ImuNoise ImuNoiseEstimate::noise() const {
  ImuNoise noise;
  noise.rate_hz = gyro.rate_hz;
  noise.gyro_noise_density = gyro.white.value;
  noise.gyro_random_walk = gyro.walk.value;
  noise.accel_noise_density = accel.white.value;
  noise.accel_random_walk = accel.walk.value;
  return noise;
}

ImuNoiseEstimate EstimateImuNoise(const std::string& name, const ImuStream& stream) {
  ImuNoiseEstimate estimate;
  estimate.gyro = EstimateSensor(name + " gyroscope", stream.gyro, kMovedRate, &estimate.warnings);
  estimate.accel =
      EstimateSensor(name + " accelerometer", stream.accel, kMovedForce, &estimate.warnings);
  return estimate;
}

}  // namespace calibrato
