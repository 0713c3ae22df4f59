#include "calibrato/calibration/optimal_weights.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numeric>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A straight line a + b x, measured anywhere in [-1, 1]: the slope is known best from both ends in
// equal parts, with a variance of 1 per measurement.
TEST(OptimalWeights, OfAStraightLineAreItsEnds) {
  std::vector<MatrixXd> information;
  for (int k = 0; k <= 20; ++k) {
    const Eigen::Vector2d row(1.0, -1.0 + 0.1 * k);
    information.push_back(row * row.transpose());
  }
  const WeightDesign slope = OptimalWeights(information, {1}, VectorXd::Ones(1), 1e-6);
  EXPECT_NEAR(slope.weights.front(), 0.5, 1e-3);
  EXPECT_NEAR(slope.weights.back(), 0.5, 1e-3);
  EXPECT_NEAR(slope.value, 1.0, 1e-5);
  EXPECT_NEAR(slope.lower_bound, 1.0, 1e-5);
}

// A-optimality of a line over [0, 1]: measured at 0 and 1 only, with the weights that minimise
// 1 / w_0 + ... by hand: covariance of (a, b) with w at 0 and v = 1 - w at 1 is
// [1/w, -1/w; -1/w, 1/w + 1/v], trace 2/w + 1/v, least at w = sqrt 2 / (1 + sqrt 2).
TEST(OptimalWeights, OfInterceptAndSlopeAreThoseFoundByHand) {
  std::vector<MatrixXd> information;
  for (const double x : {0.0, 1.0}) {
    const Eigen::Vector2d row(1.0, x);
    information.push_back(row * row.transpose());
  }
  const WeightDesign both = OptimalWeights(information, {0, 1}, VectorXd::Ones(2), 1e-8);
  EXPECT_NEAR(both.weights[0], std::sqrt(2.0) / (1.0 + std::sqrt(2.0)), 1e-4);
  EXPECT_NEAR(both.value, std::pow(1.0 + std::sqrt(2.0), 2), 1e-6);
}

TEST(OptimalWeights, AreWithinTheirCertificateAndBetterThanOthers) {
  Rng rng(3);
  std::vector<MatrixXd> information;
  for (int k = 0; k < 300; ++k) {
    MatrixXd rows(2, 5);
    for (double& entry : rows.reshaped()) entry = rng.Normal();
    information.push_back(rows.transpose() * rows);
  }
  const VectorXd unit = Eigen::Vector3d(1.0, 0.5, 2.0);
  const std::vector<Eigen::Index> block = {0, 2, 4};
  const WeightDesign design = OptimalWeights(information, block, unit, 1e-3);
  EXPECT_LE(design.value, 1.001 * design.lower_bound);
  EXPECT_NEAR(std::accumulate(design.weights.begin(), design.weights.end(), 0.0), 1.0, 1e-12);
  const auto value = [&](const std::vector<double>& weights) {
    MatrixXd sum = MatrixXd::Zero(5, 5);
    for (size_t k = 0; k < weights.size(); ++k) sum += weights[k] * information[k];
    const MatrixXd covariance = sum.inverse();
    double trace = 0.0;
    for (Eigen::Index b = 0; b < 3; ++b) {
      trace += covariance(block[static_cast<size_t>(b)], block[static_cast<size_t>(b)]) /
               (unit(b) * unit(b));
    }
    return trace;
  };
  EXPECT_NEAR(value(design.weights), design.value, 1e-9 * design.value);
  // Any mixture with other weights is no better than the bound.
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<double> other = design.weights;
    double sum = 0.0;
    for (double& w : other) sum += w = 0.9 * w + 0.2 * rng.Uniform(0.0, 1.0) / 300.0;
    for (double& w : other) w /= sum;
    EXPECT_GE(value(other), design.lower_bound);
  }
}

}  // namespace
}  // namespace calibrato
