#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibrato/learning/agent.h"

namespace calibrato {

/// The paper's: learns dynamics and reward, and plans on what they predict by model predictive
/// control (Algorithm 1).
class ModelBasedAgent final : public Agent {
 public:
  ModelBasedAgent(const LearnOptions& options, int observation_size, int horizon, Rng rng);

  void BeginTraining(const ReplayMemory& memory) override;
  TrainingLoss Train(const ReplayMemory& memory, Rng& rng) override;
  [[nodiscard]] Decision Decide(int step, const History& history, Exploration exploration,
                                Rng& rng) const override;
  /// P_best^t becomes the best of each episode's plan, then the second best of each, and so on, K
  /// in all.
  void Remember(int step, const std::vector<Decision>& decisions) override;
  void ScaleLearningRate(double factor) override;
  [[nodiscard]] std::string Bytes() const override;
  [[nodiscard]] bool Restore(std::string_view bytes, const std::string& path) override;
  [[nodiscard]] std::optional<Model> model() const override;

 private:
  const double learning_rate_;
  const PlanningOptions planning_;
  HistoryModel model_;
  ParticleMemory particle_memory_;
};

}  // namespace calibrato
