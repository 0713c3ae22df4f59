#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrato/learning/learn_options.h"
#include "calibrato/learning/mpc.h"
#include "calibrato/learning/replay_memory.h"

// To add a way of learning:
//   1. write an Agent in files of its own beside model_based_agent.h;
//   2. give it a name in MakeAgent and AgentNames;
//   3. add that name to the tests of trainer_test.cc: it trains, resumes, and finds good actions of
//      KnownEnvironment;
//   4. name it in docs/learning.md.

namespace calibrato {

/// What an agent expects of an action before it is executed.
struct Expectation {
  StepPrediction prediction;
  Eigen::VectorXd observation_unit;  ///< In which errors of the observation are counted.
};

/// A decision for one step, and what there is to report of it.
struct Decision {
  LoopCoefficients action;                 ///< Before scaling.
  std::optional<TrainingLoss> loss;        ///< Of the training before this step.
  std::optional<double> predicted_return;  ///< From this step to the end.
  std::optional<Expectation> expectation;
  Eigen::MatrixXd best;             ///< Sequences worth remembering, best first; may be empty.
  std::vector<double> best_so_far;  ///< How the search for the action converged; may be empty.
};

/// Whoever decides what to do next, and learns from what came of it.
class Agent {
 public:
  virtual ~Agent() = default;

  /// Called once, between the random episodes and the first training.
  virtual void BeginTraining(const ReplayMemory& memory) = 0;

  /// Learns; called before every step of every training episode. @pre memory.size() > 0
  virtual TrainingLoss Train(const ReplayMemory& memory, Rng& rng) = 0;

  /// Changes nothing, so that several episodes can ask at once.
  [[nodiscard]] virtual Decision Decide(int step, const History& history, Exploration exploration,
                                        Rng& rng) const = 0;

  /// Takes over what there is to remember from the decisions of all episodes of a round, at one
  /// step.
  virtual void Remember(int step, const std::vector<Decision>& decisions) = 0;

  /// Of all steps from now on, relative to that of the options, in (0, 1].
  virtual void ScaleLearningRate(double factor) = 0;

  /// Everything that training needs to go on.
  [[nodiscard]] virtual std::string Bytes() const = 0;
  /// @return False if these are bytes of an agent of another size: nothing was changed.
  /// @throws InputError that names `path`, if they are damaged.
  [[nodiscard]] virtual bool Restore(std::string_view bytes, const std::string& path) = 0;

  /// What the policy keeps of it, beside bytes: nothing unless it is made of the two networks.
  struct Model {
    HistoryModel::State networks;  ///< Without Adam's moments.
    ParticleMemory particle_memory;
  };
  [[nodiscard]] virtual std::optional<Model> model() const { return std::nullopt; }
};

/// By options.planning.planner. @pre It is one of AgentNames().
[[nodiscard]] std::unique_ptr<Agent> MakeAgent(const LearnOptions& options, int observation_size,
                                               int horizon, Rng rng);
/// ModelPlannerNames(), then "q-library", "sac".
[[nodiscard]] std::vector<std::string> AgentNames();

}  // namespace calibrato
