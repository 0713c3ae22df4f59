#include "calibrato/calibration/knot_spacing.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "calibrato/calibration/suspects.h"
#include "calibrato/geometry/spline_basis.h"

namespace calibrato {
namespace {

constexpr int kOrder = 4;
constexpr double kCoarsest = 0.4;  // [s]
constexpr double kReadingsPerCoefficient = 2.5;
constexpr size_t kMinReadings = 20;

// Generalised cross-validation of a cubic spline's fit to the readings.
double CrossValidation(const std::vector<VectorSample>& samples, double duration_s,
                       double spacing_s) {
  const auto num_segments = static_cast<int>(std::ceil(duration_s / spacing_s));
  const int n = num_segments + kOrder - 1;
  // Normal equations of band width kOrder: row i holds (i, i), (i, i + 1), .. and the right side.
  using Row = Eigen::Matrix<double, kOrder + 3, 1>;
  std::vector<Row> band(static_cast<size_t>(n), Row::Zero());
  double squares = 0.0;
  for (const VectorSample& sample : samples) {
    const double t = (sample.stamp - samples.front().stamp).seconds() / spacing_s;
    const int segment = std::clamp(static_cast<int>(t), 0, num_segments - 1);
    const auto lambda = CumulativeBasis<kOrder>(t - segment).value;
    std::array<double, kOrder> weight;
    for (size_t j = 0; j < kOrder; ++j) {
      weight[j] = lambda[j] - (j + 1 < kOrder ? lambda[j + 1] : 0.0);
    }
    for (size_t j = 0; j < kOrder; ++j) {
      Row& row = band[static_cast<size_t>(segment) + j];
      for (size_t l = j; l < kOrder; ++l) row(static_cast<int>(l - j)) += weight[j] * weight[l];
      row.tail<3>() += weight[j] * sample.value;
    }
    squares += sample.value.squaredNorm();
  }
  // A gap leaves coefficients without a reading.
  for (Row& row : band) row(0) += 1e-9;
  // Banded Cholesky; |residual|^2 = |y|^2 - |L^-1 B'y|^2.
  for (int i = 0; i < n; ++i) {
    Row& row = band[static_cast<size_t>(i)];
    const double root = std::sqrt(row(0));
    row /= root;
    squares -= row.tail<3>().squaredNorm();
    for (int j = 1; j < kOrder && i + j < n; ++j) {
      Row& later = band[static_cast<size_t>(i + j)];
      for (int l = j; l < kOrder; ++l) later(l - j) -= row(j) * row(l);
      later.tail<3>() -= row(j) * row.tail<3>();
    }
  }
  const auto num_readings = static_cast<double>(samples.size());
  const double left = 1.0 - n / num_readings;
  return squares / num_readings / (left * left);
}

// A spike is no motion: it would ask for the finest knots.
std::vector<VectorSample> WithoutSuspects(const std::vector<VectorSample>& samples) {
  const std::vector<bool> suspect = FindSuspectSamples(samples);
  std::vector<VectorSample> kept;
  kept.reserve(samples.size());
  for (size_t k = 0; k < samples.size(); ++k) {
    if (!suspect[k]) kept.push_back(samples[k]);
  }
  return kept;
}

// The spacing that predicts best; nothing for a stream too short to tell.
std::optional<double> BestSpacing(const std::vector<VectorSample>& all_samples) {
  const std::vector<VectorSample> samples = WithoutSuspects(all_samples);
  if (samples.size() < kMinReadings) return std::nullopt;
  const double duration = (samples.back().stamp - samples.front().stamp).seconds();
  if (!(duration > 0.0)) return std::nullopt;
  double best = kCoarsest;
  double least = std::numeric_limits<double>::infinity();
  for (double spacing = kCoarsest;; spacing /= std::sqrt(2.0)) {
    const double coefficients = duration / spacing + kOrder;
    if (coefficients * kReadingsPerCoefficient > static_cast<double>(samples.size())) break;
    const double validation = CrossValidation(samples, duration, spacing);
    if (validation < least) {
      least = validation;
      best = spacing;
    }
  }
  return best;
}

}  // namespace

double KnotSpacingFor(const ImuStream& stream) {
  constexpr double kDefault = 0.1;  // [s]
  const auto gyro = BestSpacing(stream.gyro);
  const auto accel = BestSpacing(stream.accel);
  if (!gyro && !accel) return kDefault;
  return std::min(gyro.value_or(kCoarsest), accel.value_or(kCoarsest)) / std::sqrt(2.0);
}

}  // namespace calibrato
