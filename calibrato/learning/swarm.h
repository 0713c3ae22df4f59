#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/learning/search.h"

namespace calibrato {

/// The paper's particle swarm (section 3.3, Table 5).
struct SwarmOptions {
  int num_particles = 15;         ///< M, >= 1.
  int num_iterations = 5;         ///< I, >= 0.
  int num_remembered = 5;         ///< K, in [0, M]: kept for the same step of later episodes.
  double social_weight = 1e-5;    ///< c1, >= 0.
  double gradient_weight = 1e-4;  ///< c2, >= 0; for gradients by unscaled coefficients.
  double inertia_weight = 1e-5;   ///< omega_0, >= 0.
  double limit = 0.015;           ///< Of every coordinate, > 0 (paper, appendix A).
  /// The original's mistake (Mistake::kFrozenSwarm): v_i <- 0.1 U(0, 1) c2 gradient(P_i), without
  /// inertia and social part. Particles stay where they are.
  bool frozen = false;
};

struct SwarmResult {
  Eigen::MatrixXd positions;      ///< Where the particles ended, the best first.
  Eigen::VectorXd values;         ///< There, freshly evaluated; descending.
  Eigen::VectorXd best_position;  ///< G_best: the best of all positions that were evaluated.
  double best_value = 0.0;
  std::vector<double> best_so_far;  ///< After each iteration and at the end: I + 1 values.
};

/// Moves a swarm by the paper's Eq. 7 and 8,
///
///     v_i <- omega_0 v_i + c1 (G_best - P_i) + c2 gradient(P_i),    P_i <- P_i + v_i,
///
/// each coordinate clipped to +-limit. The particles start at rest: the first ones at `start`, the
/// others uniform within the limits. A value that is not a number ranks below all others.
///
/// @param start  One column a particle, each of `dimension` rows; at most M (what is beyond is not
///     used).
[[nodiscard]] SwarmResult MaximiseBySwarm(const SearchObjective& objective, int dimension,
                                          const Eigen::MatrixXd& start, const SwarmOptions& options,
                                          Rng& rng);

/// For each step t of an episode the K best final positions of the last plan at that step, best
/// first (P_best^t of the paper): sequences of T - t actions, one column each; no columns before
/// the first plan.
using ParticleMemory = std::vector<Eigen::MatrixXd>;

}  // namespace calibrato
