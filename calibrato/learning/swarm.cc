#include "calibrato/learning/swarm.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace calibrato {
namespace {

double Rank(double value) {
  return std::isnan(value) ? -std::numeric_limits<double>::infinity() : value;
}

Eigen::MatrixXd StartPositions(int dimension, const Eigen::MatrixXd& start,
                               const SwarmOptions& options, Rng& rng) {
  const Eigen::Index num_given = std::min<Eigen::Index>(start.cols(), options.num_particles);
  Eigen::MatrixXd positions(dimension, options.num_particles);
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    if (i < num_given) {
      positions.col(i) = start.col(i).cwiseMax(-options.limit).cwiseMin(options.limit);
      continue;
    }
    for (Eigen::Index k = 0; k < dimension; ++k) {
      positions(k, i) = rng.Uniform(-options.limit, options.limit);
    }
  }
  return positions;
}

void UpdateBest(const Eigen::MatrixXd& positions, const Eigen::VectorXd& values,
                SwarmResult& result) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (result.best_position.size() > 0 && !(Rank(values[i]) > Rank(result.best_value))) continue;
    result.best_position = positions.col(i);
    result.best_value = values[i];
  }
  result.best_so_far.push_back(result.best_value);
}

// A tenth of the way, at most, to where the gradient leads.
Eigen::MatrixXd FrozenVelocities(const Eigen::MatrixXd& positions, const Eigen::MatrixXd& gradients,
                                 const SwarmOptions& options, Rng& rng) {
  constexpr double kCognitiveWeight = 0.1;
  const Eigen::MatrixXd led = (positions + options.gradient_weight * gradients)
                                  .cwiseMax(-options.limit)
                                  .cwiseMin(options.limit);
  Eigen::MatrixXd velocities = led - positions;
  for (double& v : velocities.reshaped()) v *= kCognitiveWeight * rng.Uniform();
  return velocities;
}

}  // namespace

SwarmResult MaximiseBySwarm(const SearchObjective& objective, int dimension,
                            const Eigen::MatrixXd& start, const SwarmOptions& options, Rng& rng) {
  assert(start.cols() == 0 || start.rows() == dimension);
  Eigen::MatrixXd positions = StartPositions(dimension, start, options, rng);
  Eigen::MatrixXd velocities = Eigen::MatrixXd::Zero(dimension, options.num_particles);
  SwarmResult result;
  for (int iteration = 0; iteration < options.num_iterations; ++iteration) {
    const SearchValues here = objective(positions, /*want_gradients=*/true);
    UpdateBest(positions, here.values, result);
    if (options.frozen) {
      velocities = FrozenVelocities(positions, here.gradients, options, rng);
    } else {
      velocities = options.inertia_weight * velocities +
                   options.social_weight *
                       (result.best_position.replicate(1, positions.cols()) - positions) +
                   options.gradient_weight * here.gradients;
    }
    positions = (positions + velocities).cwiseMax(-options.limit).cwiseMin(options.limit);
  }
  const SearchValues there = objective(positions, /*want_gradients=*/false);
  UpdateBest(positions, there.values, result);

  std::vector<Eigen::Index> order(static_cast<size_t>(options.num_particles));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&there](Eigen::Index a, Eigen::Index b) {
    return Rank(there.values[a]) > Rank(there.values[b]);
  });
  result.positions = positions(Eigen::all, order);
  result.values = there.values(order);
  return result;
}

}  // namespace calibrato
