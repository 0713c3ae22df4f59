#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "calibrato/learning/agent.h"

namespace calibrato {

/// Loops to choose from: along and about each axis once round and in a figure of twice the
/// frequency (12), and those loops of both handcrafted motions that are not among them (6), each
/// scaled to the limit.
/// @param limit  Of the largest coefficient before scaling, > 0.
[[nodiscard]] std::vector<LoopCoefficients> MotionLibrary(double limit);

/// Q-learning over a library of motions (Nobre and Heckman, "Learning to calibrate: reinforcement
/// learning for guided calibration of visual-inertial rigs", IJRR 2019): no networks, no model; a
/// table of what is still to be gained by each loop of the library, for every set of loops that
/// were executed so far (their order does not matter to a calibration). Learned from the replay
/// memory, with a step of 0.1, not discounted. Random episodes, whose actions are in no library,
/// teach it nothing.
///
/// While training it draws a loop at random with a probability that falls from 1 to 0.1 as a set's
/// loops are tried; in tests it takes the best that was tried.
class QLibraryAgent final : public Agent {
 public:
  QLibraryAgent(const LearnOptions& options, int horizon);

  void BeginTraining(const ReplayMemory&) override {}
  TrainingLoss Train(const ReplayMemory& memory, Rng& rng) override;
  [[nodiscard]] Decision Decide(int step, const History& history, Exploration exploration,
                                Rng& rng) const override;
  void Remember(int, const std::vector<Decision>&) override {}
  void ScaleLearningRate(double) override {}
  [[nodiscard]] std::string Bytes() const override;
  [[nodiscard]] bool Restore(std::string_view bytes, const std::string& path) override;

 private:
  // Which loops were executed, ascending.
  using Set = std::vector<int>;
  // Of each loop of the library.
  struct Row {
    Eigen::VectorXd value;   // What is to be gained, from here to the end.
    Eigen::VectorXd visits;  // How often this was learned from.
  };
  // -1 for an action that is not in the library.
  [[nodiscard]] int IndexOf(const LoopCoefficients& action) const;
  // Nothing if an action is not in the library.
  [[nodiscard]] std::optional<Set> SetOf(const std::vector<LoopCoefficients>& actions) const;
  // The best loop that was tried; -1 if none was.
  [[nodiscard]] int BestOf(const Set& set) const;

  const int horizon_;
  const int num_updates_;
  const std::vector<LoopCoefficients> library_;
  std::map<Set, Row> table_;
};

}  // namespace calibrato
