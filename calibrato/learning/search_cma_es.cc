#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "calibrato/learning/search.h"
#include "calibrato/learning/search_progress.h"

// Names and equation numbers as in Hansen, "The CMA evolution strategy: a tutorial", 2016.

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Constants {
  explicit Constants(int dimension) {
    const double n = dimension;
    lambda = 4 + static_cast<int>(3.0 * std::log(n));
    mu = lambda / 2;
    weights = VectorXd(mu);
    for (int i = 0; i < mu; ++i) weights[i] = std::log((lambda + 1) / 2.0) - std::log(i + 1.0);
    weights /= weights.sum();
    mu_eff = 1.0 / weights.squaredNorm();
    c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
    d_sigma = 1.0 + 2.0 * std::max(0.0, std::sqrt((mu_eff - 1.0) / (n + 1.0)) - 1.0) + c_sigma;
    c_c = (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n);
    c_1 = 2.0 / ((n + 1.3) * (n + 1.3) + mu_eff);
    c_mu =
        std::min(1.0 - c_1, 2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0) * (n + 2.0) + mu_eff));
    expected_norm = std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
  }
  int lambda;
  int mu;
  VectorXd weights;
  double mu_eff;
  double c_sigma;
  double d_sigma;
  double c_c;
  double c_1;
  double c_mu;
  double expected_norm;  // Of a standard normal vector.
};

}  // namespace

SearchResult SearchByCmaEs(const SearchObjective& objective, int dimension,
                           const SearchOptions& options, Rng& rng) {
  SearchProgress progress(objective, options);
  const Constants c(dimension);
  VectorXd mean = progress.FirstMean(dimension);
  double sigma = 0.3;
  VectorXd path_sigma = VectorXd::Zero(dimension);
  VectorXd path_c = VectorXd::Zero(dimension);
  const VectorXd spread = progress.Spread(dimension);
  MatrixXd C = spread.cwiseAbs2().asDiagonal();
  MatrixXd B = MatrixXd::Identity(dimension, dimension);
  VectorXd D = spread;
  // The eigenvectors may be a little old: an O(n^3) step once in O(n) evaluations.
  const int eigen_every =
      std::max(1, static_cast<int>(1.0 / ((c.c_1 + c.c_mu) * dimension * 10.0)));
  for (int generation = 0; progress.Allowed(c.lambda) == c.lambda; ++generation) {
    MatrixXd z(dimension, c.lambda);
    for (double& entry : z.reshaped()) entry = rng.Normal();
    const MatrixXd y = B * D.asDiagonal() * z;
    const MatrixXd positions = (sigma * y).colwise() + mean;
    const MatrixXd inside = progress.Clipped(positions);
    const VectorXd values = progress.Evaluate(inside);
    // Outside the box values say nothing about how far: ranked by the distance, behind their place.
    const VectorXd distance = (positions - inside).colwise().norm() / options.limit;
    const double range =
        values.allFinite() ? std::max(values.maxCoeff() - values.minCoeff(), 1e-12) : 1.0;
    const std::vector<Eigen::Index> order = Ranking(values - range * distance);

    VectorXd y_w = VectorXd::Zero(dimension);
    VectorXd z_w = VectorXd::Zero(dimension);
    for (int i = 0; i < c.mu; ++i) {
      y_w += c.weights[i] * y.col(order[static_cast<size_t>(i)]);
      z_w += c.weights[i] * z.col(order[static_cast<size_t>(i)]);
    }
    mean += sigma * y_w;
    path_sigma = (1.0 - c.c_sigma) * path_sigma +
                 std::sqrt(c.c_sigma * (2.0 - c.c_sigma) * c.mu_eff) * (B * z_w);
    const double decay = 1.0 - std::pow(1.0 - c.c_sigma, 2.0 * (generation + 1));
    const bool too_long =
        path_sigma.norm() / std::sqrt(decay) >= (1.4 + 2.0 / (dimension + 1.0)) * c.expected_norm;
    const double h_sigma = too_long ? 0.0 : 1.0;
    path_c = (1.0 - c.c_c) * path_c + h_sigma * std::sqrt(c.c_c * (2.0 - c.c_c) * c.mu_eff) * y_w;
    MatrixXd rank_mu = MatrixXd::Zero(dimension, dimension);
    for (int i = 0; i < c.mu; ++i) {
      const auto column = y.col(order[static_cast<size_t>(i)]);
      rank_mu.selfadjointView<Eigen::Lower>().rankUpdate(column, c.weights[i]);
    }
    rank_mu = MatrixXd(rank_mu.selfadjointView<Eigen::Lower>());
    const double lost = (1.0 - h_sigma) * c.c_c * (2.0 - c.c_c);
    C = (1.0 - c.c_1 - c.c_mu + c.c_1 * lost) * C + c.c_1 * path_c * path_c.transpose() +
        c.c_mu * rank_mu;
    sigma *= std::exp(c.c_sigma / c.d_sigma * (path_sigma.norm() / c.expected_norm - 1.0));
    if ((generation + 1) % eigen_every == 0) {
      const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(C);
      B = solver.eigenvectors();
      D = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    }
  }
  return progress.result();
}

}  // namespace calibrato
