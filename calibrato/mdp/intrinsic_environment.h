#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/mdp/calibration_status.h"
#include "calibrato/mdp/environment.h"
#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/simulation/fidelity.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {

/// Weights of Eq. 3 for the intrinsic task (paper, Table 5), and the two decisions that the paper
/// leaves open (docs/differences.md).
struct IntrinsicRewardWeights {
  double coverage = 1.0;  ///< eta_1, of the sum of the four coverages [-].
  double information =
      0.0;  ///< eta_2 [1/nat], of IntrinsicInformationStatus; the paper has none in this task.
  double relative_error = 1.0;  ///< eta_3, of the fall of the relative error [-].
  /// eta_3', of the fall of the reprojection error [1/px], in place of the relative error where the
  /// truth is unknown (appendix C): 0 or, with relative_error and accuracy_bonus 0, 2.
  double reprojection = 0.0;
  double path_length = 0.2;     ///< eta_4 [1/m]
  double accuracy_bonus = 5.0;  ///< Once, when the relative error first falls below 1 %.
  double refusal = -1.0;        ///< For an action that the carrier can't make.
};

/// Where the episodes of the intrinsic task take place.
struct IntrinsicTask {
  int num_loops = NumLoops(Task::kIntrinsic);  ///< Of an episode, T >= 1.
  Carrier carrier = Carrier::kFree;
  Fidelity fidelity = Fidelity::kFast;
  RigDistribution rigs = RigDistribution::kPaper;
  std::optional<Rig> fixed_rig;  ///< Every episode with this one instead.
  IntrinsicRewardWeights weights;
  DesignCriterion criterion = DesignCriterion::kA;
  /// Of the solver. Weak calibrations are the rule after the first loop; a hundred iterations on
  /// them are wasted.
  int max_iterations = 50;
  Mistakes mistakes;
};

/// The intrinsic task: four loops, after each of which the camera is calibrated anew from all
/// frames that count so far.
///
/// Observation, 8 numbers: the estimate of fu fv pu pv over its prior mean, then the progress of X,
/// Y, size and skew. Before any data, and while the data do not determine the camera
/// (CalibrateIntrinsics), the estimate is the prior mean.
///
/// Reward terms: coverage, information, relative_error, reprojection, path_length, accuracy_bonus,
/// refusal.
class IntrinsicEnvironment final : public Environment {
 public:
  explicit IntrinsicEnvironment(IntrinsicTask task) : task_(std::move(task)) {}

  [[nodiscard]] std::unique_ptr<Environment> Clone() const override {
    return std::make_unique<IntrinsicEnvironment>(*this);
  }
  [[nodiscard]] int observation_size() const override { return 8; }
  [[nodiscard]] int horizon() const override { return task_.num_loops; }
  void SetConditions(const EpisodeConditions& conditions) override { conditions_ = conditions; }
  Eigen::VectorXd Reset(const Rng& rng) override;
  StepResult Step(const LoopCoefficients& action) override;
  [[nodiscard]] double relative_error() const override { return status_.relative_error; }
  [[nodiscard]] double carried_over() const override;
  void CarryOver(double carried_over) override {
    carried_coverage_ = carried_over;
    num_steps_ = 0;  // Whatever was played here does not count.
  }

 private:
  void Record(const TimedMotion& motion, const Rng& noise);
  // With the original's constant: 1 until the last loop.
  [[nodiscard]] double RewardedError() const;

  IntrinsicTask task_;
  EpisodeConditions conditions_;
  double carried_coverage_ = 0.0;
  // One episode:
  Rng noise_{0};
  Rig rig_;
  BasePose base_pose_;
  int num_steps_ = 0;
  Time now_;
  std::vector<BoardView> views_;
  Coverage coverage_;
  IntrinsicStatus status_;
  bool bonus_paid_ = false;
};

}  // namespace calibrato
