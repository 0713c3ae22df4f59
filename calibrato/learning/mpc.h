#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrato/learning/networks.h"
#include "calibrato/learning/swarm.h"

// To add a planner that searches the networks' predicted return:
//   1. write its search in a file of its own, of the shape of Search in search.h;
//   2. give it a name in SearchFromName;
//   3. add it to the tests of search_test.cc: every planner finds the best of a known function;
//   4. name it in docs/learning.md. Nothing else: PlanAction, the policy's files and the command
//      line take planners by their names.
// One that learns something else than the two networks is an Agent: agent.h.

namespace calibrato {

/// The planner of the paper: the swarm of swarm.h.
inline constexpr const char* kPaperPlanner = "pso-paper";

/// Model predictive control (paper, section 3.3).
struct PlanningOptions {
  /// "pso-paper", or one of SearchNames().
  std::string planner = kPaperPlanner;
  SwarmOptions swarm;
  /// W, in [1, M]: a training episode executes one of the best W sequences, drawn uniformly. The
  /// paper asks for W > K in its text, so that fresh particles are among them, and takes W = K = 5
  /// in its Table 5; the table is what it ran.
  int num_candidates = 5;
};

/// How many sequences a plan may evaluate, whoever plans: M (I + 1), those of the paper's swarm,
/// which is given the gradients of M I of them as well.
[[nodiscard]] int NumEvaluations(const PlanningOptions& options);

/// "pso-paper" and SearchNames().
[[nodiscard]] std::vector<std::string> ModelPlannerNames();

/// Who asks for a plan.
enum class Exploration {
  kTraining,  ///< One of the best W.
  kTesting,   ///< The best.
};

struct Plan {
  LoopCoefficients action;  ///< The first of the chosen sequence, before scaling: to be executed.
  double predicted_return = 0.0;    ///< Of the chosen sequence, from here to the end.
  Eigen::MatrixXd best;             ///< The best K sequences, best first: P_best^t.
  std::vector<double> best_so_far;  ///< Highest predicted return after each round of the search.
};

/// Searches the best sequence of actions from here to the end of the episode, by the planner on the
/// networks' predicted return, and chooses one.
/// @param num_steps  Left in the episode, T - t, >= 1.
/// @param remembered  P_best^t of an earlier episode: 36 num_steps rows; no columns if there was
///     none. Where a planner begins, as far as it can.
/// @pre options.planner is one of ModelPlannerNames().
[[nodiscard]] Plan PlanAction(const HistoryModel& model, const History& history, int num_steps,
                              const Eigen::MatrixXd& remembered, const PlanningOptions& options,
                              Exploration exploration, Rng& rng);

}  // namespace calibrato
