#include "calibrato/learning/gaussian_process.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace calibrato {

GaussianProcess::GaussianProcess(Eigen::MatrixXd points, const Eigen::VectorXd& values,
                                 const GaussianProcessOptions& options)
    : points_(std::move(points)), options_(options) {
  assert(points_.cols() == values.size());
  assert(options.length_scale > 0.0 && options.signal_stddev > 0.0 && options.noise_stddev > 0.0);
  const Eigen::Index n = points_.cols();
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) covariance(i, j) = Kernel(points_.col(i), points_.col(j));
    covariance(i, i) += options.noise_stddev * options.noise_stddev;
  }
  factor_.compute(covariance);
  weights_ = factor_.solve(values);
}

double GaussianProcess::Kernel(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  const double distance = (a - b).norm() / options_.length_scale;
  return options_.signal_stddev * options_.signal_stddev * std::exp(-0.5 * distance * distance);
}

Belief GaussianProcess::At(const Eigen::VectorXd& point) const {
  Eigen::VectorXd covariance(points_.cols());
  for (Eigen::Index i = 0; i < covariance.size(); ++i) {
    covariance(i) = Kernel(points_.col(i), point);
  }
  const double explained = factor_.matrixL().solve(covariance).squaredNorm();
  const double variance = Kernel(point, point) - explained;
  return {covariance.dot(weights_), std::sqrt(std::max(0.0, variance))};
}

}  // namespace calibrato
