#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibrato/learning/agent.h"
#include "calibrato/learning/perceptron.h"

namespace calibrato {

/// Soft actor critic (Haarnoja, Zhou, Abbeel, Levine, ICML 2018; with the temperature learned, as
/// in their "Soft actor-critic algorithms and applications", 2018): model-free, what the paper's
/// conclusion proposes. It neither models dynamics nor searches. Of five critics the least is
/// believed (Chen, Wang, Zhou, Ross, "Randomized ensembled double Q-learning", ICLR 2021), and they
/// are trained on noisy actions: the source says why.
///
/// What it sees: the step, the observation and all actions so far, zeros for those to come. Returns
/// are not discounted; an episode's last step is an end. Targets follow with a share of 0.005.
/// Minibatches are those of NetworkOptions; layers have a quarter of its units, and the learning
/// rate is ten times its.
class SacAgent final : public Agent {
 public:
  SacAgent(const LearnOptions& options, int observation_size, int horizon, Rng rng);

  void BeginTraining(const ReplayMemory& memory) override;
  TrainingLoss Train(const ReplayMemory& memory, Rng& rng) override;
  [[nodiscard]] Decision Decide(int step, const History& history, Exploration exploration,
                                Rng& rng) const override;
  void Remember(int, const std::vector<Decision>&) override {}
  void ScaleLearningRate(double factor) override { learning_rate_ = factor * given_rate_; }
  [[nodiscard]] std::string Bytes() const override;
  [[nodiscard]] bool Restore(std::string_view bytes, const std::string& path) override;

  /// Actions of a policy for some states, one column each, in units of the limit.
  struct Sample {
    Eigen::MatrixXd action;  ///< tanh(mean + stddev noise)
    Eigen::VectorXd log_density;
  };
  [[nodiscard]] Sample SampleAt(const Eigen::MatrixXd& policy_output,
                                const Eigen::MatrixXd& noise) const;
  /// Derivative by the policy's output of the sum over columns of
  /// temperature log_density + <by_action, action>.
  [[nodiscard]] Eigen::MatrixXd SampleGradient(const Eigen::MatrixXd& policy_output,
                                               const Eigen::MatrixXd& noise, double temperature,
                                               const Eigen::MatrixXd& by_action) const;

 private:
  struct Batch;
  struct Opinions;
  [[nodiscard]] static Opinions Ask(const std::vector<Perceptron>& critics,
                                    const Eigen::MatrixXd& inputs);
  [[nodiscard]] Eigen::VectorXd State(const History& history) const;
  [[nodiscard]] Batch Draw(const ReplayMemory& memory, Rng& rng) const;
  double TrainCritics(const Batch& batch, Rng& rng);
  void TrainActor(const Batch& batch, Rng& rng);

  const NetworkOptions options_;
  const double limit_;
  const int horizon_;
  const double given_rate_;
  double learning_rate_;
  Normalisation normalisation_;
  Perceptron actor_;
  std::vector<Perceptron> critics_;  // Five.
  std::vector<Perceptron> targets_;  // Of the critics.
  double log_temperature_ = 0.0;
};

}  // namespace calibrato
