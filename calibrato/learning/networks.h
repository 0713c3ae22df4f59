#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/learning/history.h"
#include "calibrato/learning/normalisation.h"
#include "calibrato/learning/replay_memory.h"

namespace calibrato {

/// Size and training of the two networks (paper, Table 5, and the original implementation).
struct NetworkOptions {
  int hidden_size = 256;         ///< Units of every layer but the last, in [1, 4096].
  double learning_rate = 1e-4;   ///< Adam, of either network, > 0.
  int minibatch_size = 32;       ///< Transitions, >= 1.
  int minibatches_per_call = 8;  ///< Gradient steps of either network in one Train(), >= 1.
  /// Standard deviation of the noise on the current action of every transition in a minibatch, in
  /// units of the action's limit, >= 0. Networks of this size learn a few hundred transitions by
  /// heart, and then the swarm climbs what is not there; the noise makes them smooth over that
  /// distance (Bishop, "Training with noise is equivalent to Tikhonov regularization", Neural
  /// Computation 1995). Not in the paper.
  double action_jitter = 0.5;
  /// The original's mistake (Mistake::kMaskedHistories): a history is encoded without the pairs
  /// that have no action before them (the first) or an observation that is still that of the start
  /// (no calibration yet). What is left may be nothing.
  bool mask_histories = false;
};

/// Mean squared errors over the minibatches of one Train(), in normalised units.
struct TrainingLoss {
  double dynamics = 0.0;  ///< Paper, Eq. 4: squared norm over the observation.
  double reward = 0.0;    ///< Paper, Eq. 5.
};

/// What both networks remember of a history: their recurrent layers' states.
struct EncodedHistory {
  Eigen::VectorXf dynamics;
  Eigen::VectorXf reward;
};

/// What the networks expect of one action.
struct StepPrediction {
  Eigen::VectorXd next_observation;
  double reward = 0.0;
};

/// What the networks expect of sequences of actions until the end of the episode.
struct PredictedReturns {
  Eigen::VectorXd values;     ///< Sum of the predicted rewards (paper, Eq. 6), not discounted.
  Eigen::MatrixXd gradients;  ///< Of the value by the actions before scaling; empty unless asked.
};

/// All numbers of one network, in the order of its layers.
struct NetworkWeights {
  std::vector<float> weights;
  std::vector<float> first_moment;   ///< Adam's; empty in a policy, which is not trained further.
  std::vector<float> second_moment;  ///< Likewise.
  int64_t num_updates = 0;           ///< Adam steps taken.
};

/// The learned dynamics f_phi(history, action) -> next observation and reward g_psi(history,
/// action) -> reward (paper, section 3.3, Figure 2): two networks of the same shape,
///
///     h = GRU over the pairs (Y_k, A_{k-1}), k = 0 .. t, with A_{-1} = 0: its last state
///     output = Dense(Dense_relu([h, Dense(A_t)]))
///
/// Every history is encoded over exactly its own t + 1 pairs; nothing is padded or masked. Actions
/// enter divided by their limit, observations and rewards normalised.
///
/// Single precision, each network on one thread; matrix products don't go through BLAS, whose
/// result depends on which of its implementations is installed. The same seed gives the same bytes
/// on the same processor; elementary functions may differ in the last bit between processors with
/// and without AVX.
class HistoryModel {
 public:
  /// Weights uniform in +-1/sqrt(n), n the layer's inputs (recurrent layer: its units).
  /// @param action_limit  Largest coefficient of an action before scaling, > 0.
  HistoryModel(int observation_size, const NetworkOptions& options, double action_limit, Rng& rng);
  ~HistoryModel();
  HistoryModel(HistoryModel&&) noexcept;
  HistoryModel& operator=(HistoryModel&&) noexcept;

  [[nodiscard]] int observation_size() const;
  [[nodiscard]] const NetworkOptions& options() const;

  /// Of both networks' steps from now on, > 0.
  void SetLearningRate(double learning_rate);

  /// UnitNormalisation() until set.
  void SetNormalisation(const Normalisation& normalisation);
  [[nodiscard]] const Normalisation& normalisation() const;

  /// Takes minibatches_per_call Adam steps with either network, on minibatches drawn with
  /// replacement. Stops at the first loss that is not finite, and returns it.
  /// @pre memory.size() > 0
  TrainingLoss Train(const ReplayMemory& memory, Rng& rng);

  [[nodiscard]] EncodedHistory Encode(const History& history) const;

  [[nodiscard]] StepPrediction PredictStep(const EncodedHistory& history,
                                           const LoopCoefficients& action) const;

  /// Unrolls both networks over sequences of actions (paper, Eq. 6).
  /// @param actions  One column a sequence, 36 rows an action.
  [[nodiscard]] PredictedReturns PredictReturns(const EncodedHistory& history,
                                                const Eigen::MatrixXd& actions,
                                                bool want_gradients) const;

  struct State {
    Normalisation normalisation;
    NetworkWeights dynamics;
    NetworkWeights reward;
  };
  [[nodiscard]] State state() const;
  /// @pre The state is of a model of the same sizes; moments may be empty (they restart at 0).
  void Restore(const State& state);
  /// How many weights such a state has.
  [[nodiscard]] size_t num_dynamics_weights() const;
  [[nodiscard]] size_t num_reward_weights() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace calibrato
