#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrato/base/rng.h"

// Planners that need nothing but values: they search the best position in a box, whatever its value
// means. (The paper's own swarm, which needs gradients too: swarm.h.)

namespace calibrato {

/// What is to be maximised, at many positions at once.
struct SearchValues {
  Eigen::VectorXd values;  ///< One a position.
  Eigen::MatrixXd
      gradients;  ///< Of the value by position, one column each; empty unless asked for.
};

/// @param positions  One column each.
using SearchObjective =
    std::function<SearchValues(const Eigen::MatrixXd& positions, bool want_gradients)>;

struct SearchOptions {
  double limit = 0.015;        ///< Of every coordinate, > 0: the box is +-limit.
  int num_evaluations = 1000;  ///< Of one position each, >= 1; the last round is cut to it.
  /// Positions to begin with (one column each; what is outside the box is clipped), for those
  /// methods that can use them; may be empty.
  Eigen::MatrixXd start;
  /// Spread of the first draws, as a share of the limit for each coordinate; empty: alike. Motions
  /// are smooth: a coefficient of the fourth harmonic is worth less than one of the first.
  Eigen::VectorXd relative_spread;
};

struct SearchResult {
  Eigen::VectorXd best_position;
  double best_value = 0.0;
  int num_evaluations = 0;
  std::vector<double> best_so_far;  ///< After each round.
};

/// Uniform draws (Nagabandi, Kahn, Fearing, Levine, ICRA 2018).
[[nodiscard]] SearchResult SearchByRandomShooting(const SearchObjective& objective, int dimension,
                                                  const SearchOptions& options, Rng& rng);

/// Particle swarm with inertia 0.7, personal weight 0.5, social weight 0.6: the original
/// implementation's own ancestor (its branch PLR2020), without gradients. 15 particles.
[[nodiscard]] SearchResult SearchByPlainSwarm(const SearchObjective& objective, int dimension,
                                              const SearchOptions& options, Rng& rng);

/// PSO-P (Hein, Hentschel, Runkler, Udluft, 2016): particles know the best of their neighbours in a
/// ring of four only; inertia 0.72981, both weights 1.49618. 100 particles.
[[nodiscard]] SearchResult SearchByPsoP(const SearchObjective& objective, int dimension,
                                        const SearchOptions& options, Rng& rng);

/// Cross-entropy method: normal draws, refitted to the best tenth of 100.
[[nodiscard]] SearchResult SearchByCem(const SearchObjective& objective, int dimension,
                                       const SearchOptions& options, Rng& rng);

/// iCEM (Pinneri, Sawant, Blaes, Achterhold, Stueckler, Rolinek, Martius, CoRL 2020): cross-entropy
/// with the best ones kept from round to round, populations that shrink by 1.25, and the mean
/// itself among the last draws. Its coloured noise is here `relative_spread`: an action is a
/// spectrum.
[[nodiscard]] SearchResult SearchByIcem(const SearchObjective& objective, int dimension,
                                        const SearchOptions& options, Rng& rng);

/// CMA-ES with the constants of Hansen, "The CMA evolution strategy: a tutorial", 2016; positions
/// outside the box are clipped to it for their value, and the distance is charged.
[[nodiscard]] SearchResult SearchByCmaEs(const SearchObjective& objective, int dimension,
                                         const SearchOptions& options, Rng& rng);

/// By name: random-shooting, pso, pso-p, cem, icem, cma-es (docs/formats.md).
/// @throws InputError for any other, with their list.
using Search = SearchResult (*)(const SearchObjective&, int, const SearchOptions&, Rng&);
[[nodiscard]] Search SearchFromName(std::string_view name);
[[nodiscard]] std::vector<std::string> SearchNames();

}  // namespace calibrato
