#pragma once

#include <Eigen/Core>

#include "calibrato/learning/networks.h"
#include "calibrato/learning/swarm.h"

// To add a planner:
//   1. write its search beside swarm.h: from predicted returns to sequences, best first;
//   2. give it a name in PlanningOptions, by which PlanAction calls it instead of the swarm;
//   3. write its options into policy.cc, so that a policy says how it plans;
//   4. add it to the tests of mpc_test.cc: every planner finds the best of a known return.

namespace calibrato {

/// Model predictive control (paper, section 3.3).
struct PlanningOptions {
  SwarmOptions swarm;
  /// W, in [1, M]: a training episode executes one of the best W sequences, drawn uniformly. The
  /// paper asks for W > K in its text, so that fresh particles are among them, and takes W = K = 5
  /// in its Table 5; the table is what it ran.
  int num_candidates = 5;
};

/// Who asks for a plan.
enum class Exploration {
  kTraining,  ///< One of the best W.
  kTesting,   ///< The best.
};

struct Plan {
  LoopCoefficients action;  ///< The first of the chosen sequence, before scaling: to be executed.
  double predicted_return = 0.0;  ///< Of the chosen sequence, from here to the end.
  Eigen::MatrixXd best;           ///< The best K sequences, best first: P_best^t.
};

/// Searches the best sequence of actions from here to the end of the episode, by a swarm on the
/// networks' predicted return, and chooses one.
/// @param num_steps  Left in the episode, T - t, >= 1.
/// @param remembered  P_best^t of an earlier episode: 36 num_steps rows; no columns if there was
///     none.
[[nodiscard]] Plan PlanAction(const HistoryModel& model, const History& history, int num_steps,
                              const Eigen::MatrixXd& remembered, const PlanningOptions& options,
                              Exploration exploration, Rng& rng);

}  // namespace calibrato
