#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace calibrato {

/// What a function is believed to be at a point.
struct Belief {
  double mean = 0.0;
  double stddev = 0.0;  ///< Of the function itself, without the noise of measuring it.
};

struct GaussianProcessOptions {
  double length_scale = 0.5;   ///< Of every coordinate, > 0.
  double signal_stddev = 0.3;  ///< Of the function about its prior mean, 0; > 0.
  double noise_stddev = 0.1;   ///< Of a value that was measured, > 0.
};

/// A function of few coordinates, learned from few noisy values: Gaussian process regression with
/// the squared exponential kernel and prior mean 0 (Rasmussen, Williams, 2006, Algorithm 2.1).
class GaussianProcess {
 public:
  /// @param points  One column each; may have none.
  /// @param values  One a point.
  GaussianProcess(Eigen::MatrixXd points, const Eigen::VectorXd& values,
                  const GaussianProcessOptions& options);

  [[nodiscard]] Belief At(const Eigen::VectorXd& point) const;

 private:
  [[nodiscard]] double Kernel(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;

  Eigen::MatrixXd points_;
  GaussianProcessOptions options_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd weights_;
};

}  // namespace calibrato
