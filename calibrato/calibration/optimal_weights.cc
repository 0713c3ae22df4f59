#include "calibrato/calibration/optimal_weights.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace calibrato {
namespace {

// A candidate that is as light as this, and less sensitive than the others by the margin of the
// certificate, is not looked at until the end.
constexpr double kLight = 1e-10;

}  // namespace

WeightDesign OptimalWeights(const std::vector<Eigen::MatrixXd>& information,
                            const std::vector<Eigen::Index>& block, const Eigen::VectorXd& unit,
                            double tolerance, int max_iterations) {
  assert(!information.empty());
  const Eigen::Index size = information.front().rows();
  const size_t n = information.size();
  // Candidates as columns: sums and sensitivities are matrix-vector products.
  Eigen::MatrixXd columns(size * size, static_cast<Eigen::Index>(n));
  for (size_t k = 0; k < n; ++k) {
    columns.col(static_cast<Eigen::Index>(k)) = information[k].reshaped();
  }
  Eigen::MatrixXd wanted = Eigen::MatrixXd::Zero(size, static_cast<Eigen::Index>(block.size()));
  for (size_t b = 0; b < block.size(); ++b) {
    const auto column = static_cast<Eigen::Index>(b);
    wanted(block[b], column) = 1.0 / unit(column);
  }

  std::vector<Eigen::Index> active(n);
  std::iota(active.begin(), active.end(), Eigen::Index{0});
  Eigen::VectorXd weights =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(n), 1.0 / static_cast<double>(n));
  WeightDesign design;
  const auto sensitivities = [&](const std::vector<Eigen::Index>& of) -> Eigen::VectorXd {
    const Eigen::VectorXd sum = columns(Eigen::all, active) * weights(active);
    const Eigen::LLT<Eigen::MatrixXd> llt(sum.reshaped(size, size));
    const Eigen::MatrixXd X = llt.solve(wanted);
    design.value = wanted.cwiseProduct(X).sum();
    const Eigen::MatrixXd XX = X * X.transpose();
    if (of.size() == n) return columns.transpose() * XX.reshaped();
    return columns(Eigen::all, of).transpose() * XX.reshaped();
  };
  std::vector<Eigen::Index> all = active;
  for (design.num_iterations = 0; design.num_iterations < max_iterations; ++design.num_iterations) {
    // All candidates now and then: for the certificate, and lest one be forgotten too early.
    if (design.num_iterations % 50 == 0) {
      const Eigen::VectorXd d = sensitivities(all);
      design.lower_bound = design.value * design.value / d.maxCoeff();
      if (design.value <= (1.0 + tolerance) * design.lower_bound) break;
      active.clear();
      for (const Eigen::Index k : all) {
        const bool promising = d(k) > design.value;
        if (promising) weights(k) = std::max(weights(k), 2.0 * kLight);
        if (weights(k) > kLight) active.push_back(k);
      }
    }
    const Eigen::VectorXd d = sensitivities(active);
    weights(active).array() *= d.array().sqrt();
    weights(active) /= weights(active).sum();
  }
  design.weights.assign(n, 0.0);
  const double sum = weights(active).sum();
  for (const Eigen::Index k : active) design.weights[static_cast<size_t>(k)] = weights(k) / sum;
  return design;
}

}  // namespace calibrato
