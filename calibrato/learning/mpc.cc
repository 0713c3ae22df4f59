#include "calibrato/learning/mpc.h"

#include <cassert>

namespace calibrato {

Plan PlanAction(const HistoryModel& model, const History& history, int num_steps,
                const Eigen::MatrixXd& remembered, const PlanningOptions& options,
                Exploration exploration, Rng& rng) {
  assert(num_steps >= 1);
  assert(options.num_candidates >= 1 && options.num_candidates <= options.swarm.num_particles);
  constexpr int kActionSize = LoopCoefficients::RowsAtCompileTime;
  // The history is the same for all particles and iterations.
  const EncodedHistory encoded = model.Encode(history);
  const SearchObjective predicted_return = [&](const Eigen::MatrixXd& actions,
                                               bool want_gradients) {
    PredictedReturns predicted = model.PredictReturns(encoded, actions, want_gradients);
    return SearchValues{std::move(predicted.values), std::move(predicted.gradients)};
  };
  const SwarmResult swarm =
      MaximiseBySwarm(predicted_return, kActionSize * num_steps, remembered, options.swarm, rng);
  const Eigen::Index chosen = exploration == Exploration::kTesting
                                  ? 0
                                  : static_cast<Eigen::Index>(rng.UniformIndex(
                                        static_cast<uint64_t>(options.num_candidates)));
  return {swarm.positions.col(chosen).head<kActionSize>(), swarm.values[chosen],
          swarm.positions.leftCols(options.swarm.num_remembered)};
}

}  // namespace calibrato
