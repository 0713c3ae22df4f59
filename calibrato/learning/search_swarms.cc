#include <algorithm>

#include "calibrato/learning/search.h"
#include "calibrato/learning/search_progress.h"

namespace calibrato {
namespace {

struct SwarmWeights {
  int num_particles;
  double inertia;
  double personal;
  double social;
  int num_neighbours;  // On either side of a ring; 0: everyone knows everyone.
};

// The best personal best among a particle's neighbours, itself included.
Eigen::Index BestNeighbour(const Eigen::VectorXd& values, Eigen::Index i, int num_neighbours) {
  Eigen::Index best = i;
  const Eigen::Index n = values.size();
  if (num_neighbours == 0) {
    values.maxCoeff(&best);
    return best;
  }
  for (int step = -num_neighbours; step <= num_neighbours; ++step) {
    const Eigen::Index other = (i + step + n) % n;
    if (values[other] > values[best]) best = other;
  }
  return best;
}

SearchResult SearchBySwarm(const SearchObjective& objective, int dimension,
                           const SearchOptions& options, const SwarmWeights& weights, Rng& rng) {
  SearchProgress progress(objective, options);
  const int count = progress.Allowed(weights.num_particles);
  Eigen::MatrixXd positions = progress.Start(dimension, count, rng);
  Eigen::MatrixXd velocities = Eigen::MatrixXd::Zero(dimension, count);
  Eigen::MatrixXd best = positions;
  Eigen::VectorXd best_values = progress.Evaluate(positions);
  while (progress.Allowed(count) == count) {
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index leader = BestNeighbour(best_values, i, weights.num_neighbours);
      for (Eigen::Index k = 0; k < dimension; ++k) {
        const double own = weights.personal * rng.Uniform();
        const double others = weights.social * rng.Uniform();
        velocities(k, i) = weights.inertia * velocities(k, i) +
                           own * (best(k, i) - positions(k, i)) +
                           others * (best(k, leader) - positions(k, i));
      }
    }
    positions = progress.Clipped(positions + velocities);
    const Eigen::VectorXd values = progress.Evaluate(positions);
    for (Eigen::Index i = 0; i < count; ++i) {
      if (!(values[i] > best_values[i])) continue;
      best_values[i] = values[i];
      best.col(i) = positions.col(i);
    }
  }
  return progress.result();
}

}  // namespace

SearchResult SearchByPlainSwarm(const SearchObjective& objective, int dimension,
                                const SearchOptions& options, Rng& rng) {
  return SearchBySwarm(objective, dimension, options, {15, 0.7, 0.5, 0.6, 0}, rng);
}

SearchResult SearchByPsoP(const SearchObjective& objective, int dimension,
                          const SearchOptions& options, Rng& rng) {
  return SearchBySwarm(objective, dimension, options, {100, 0.72981, 1.49618, 1.49618, 2}, rng);
}

}  // namespace calibrato
