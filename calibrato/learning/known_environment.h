#pragma once

// For tests of the room: an environment whose best action is known.

#include <cassert>
#include <memory>

#include "calibrato/mdp/environment.h"

namespace calibrato {

/// Every step is best with the same action: reward = 4 (1 - |a - a*|^2 / (36 * 0.015^2)), at most
/// 4; about 0.9 on average for uniform actions. The observation is linear in the history: the sums
/// of the first coefficients over the episode, in units of 0.015, and the rig's own number. With a
/// first coefficient above `refuse_above` an action is refused, and costs 2.
class KnownEnvironment : public Environment {
 public:
  explicit KnownEnvironment(int horizon = 2, double refuse_above = 1.0)
      : horizon_(horizon), refuse_above_(refuse_above) {}

  static LoopCoefficients BestAction() {
    LoopCoefficients best;
    for (int i = 0; i < best.size(); ++i) best[i] = i % 2 == 0 ? 0.01 : -0.01;
    return best;
  }

  [[nodiscard]] std::unique_ptr<Environment> Clone() const override {
    return std::make_unique<KnownEnvironment>(*this);
  }
  [[nodiscard]] int observation_size() const override { return 3; }
  [[nodiscard]] int horizon() const override { return horizon_; }

  Eigen::VectorXd Reset(const Rng& rng) override {
    Rng rig = rng.Stream("rig");
    observation_ = Eigen::Vector3d(0.0, 0.0, rig.Normal());
    num_steps_ = 0;
    return observation_;
  }

  StepResult Step(const LoopCoefficients& action) override {
    assert(num_steps_ < horizon_);
    ++num_steps_;
    StepResult result;
    if (action[0] > refuse_above_) {
      result.executed = false;
      result.terms = {{"refusal", "refusals", 1.0, -2.0}};
      result.reward = -2.0;
    } else {
      observation_.head<2>() += action.head<2>() / 0.015;
      error_ = (action - BestAction()).squaredNorm() / (36.0 * 0.015 * 0.015);
      result.terms = {{"presence", "presence", 1.0, 4.0}, {"distance", "distance", error_, -4.0}};
      result.reward = 4.0 - 4.0 * error_;
    }
    result.observation = observation_;
    return result;
  }

  [[nodiscard]] double relative_error() const override { return error_; }

 private:
  int horizon_;
  double refuse_above_;
  Eigen::Vector3d observation_ = Eigen::Vector3d::Zero();
  int num_steps_ = 0;
  double error_ = 1.0;
};

}  // namespace calibrato
