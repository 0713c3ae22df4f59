#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "calibrato/mdp/calibration_status.h"
#include "calibrato/mdp/environment.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/simulation/fidelity.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {

/// Weights of Eq. 3 for the extrinsic task (paper, Table 5).
struct ExtrinsicRewardWeights {
  double empirical = 1.0;  ///< eta_1, of IMU entropy [1/nat] and of boards per frame [-] alike.
  /// eta_2 [1/nat], of InformationStatus. The paper's 1e8 belongs to the trace of its conditional,
  /// unnormalised covariance: one loop brings that from about 1e-6 to 1e-7, a reward of 10 to 100
  /// at once and of 0.1 after. A nat here is a factor e in sigma, wherever it happens.
  double information = 1.0;
  double relative_error = 1.0;  ///< eta_3, of the fall of the relative error [-].
  /// eta_3', of the fall of the reprojection error [1/px], in place of the relative error where the
  /// truth is unknown (appendix C): 0 or, with relative_error 0, 2.
  double reprojection = 0.0;
  double path_length = 1.0;  ///< eta_4 [1/m]
  double refusal = -1.0;     ///< For an action that the carrier can't make.
};

/// Where the episodes of the extrinsic task take place.
struct ExtrinsicTask {
  int num_loops = NumLoops(Task::kExtrinsic);  ///< Of an episode, T >= 1.
  Carrier carrier = Carrier::kFree;
  Fidelity fidelity = Fidelity::kFast;
  RigDistribution rigs = RigDistribution::kPaper;
  std::optional<Rig> fixed_rig;  ///< Every episode with this one instead.
  ExtrinsicRewardWeights weights;
  DesignCriterion criterion = DesignCriterion::kA;
  int max_iterations = 50;  ///< Of the solver, each time it is called; conditions may differ.
  Mistakes mistakes;
};

/// The extrinsic task: three loops, after each of which camera and IMU are calibrated anew from
/// everything recorded so far, the camera's intrinsics being known.
///
/// Observation, 12 numbers: the estimate's difference to the prior mean [rotation, translation] in
/// the prior's sigmas, then half the logarithms of the six eigenvalues, ascending, of the
/// normalised covariance. Before any data, and while the data do not determine the extrinsics
/// (fewer than three frames, rank-deficient), both are the prior's.
///
/// Reward terms: imu_entropy, boards_per_frame, information, relative_error, reprojection,
/// path_length, refusal.
class ExtrinsicEnvironment final : public Environment {
 public:
  explicit ExtrinsicEnvironment(ExtrinsicTask task) : task_(std::move(task)) {}

  [[nodiscard]] std::unique_ptr<Environment> Clone() const override {
    return std::make_unique<ExtrinsicEnvironment>(*this);
  }
  [[nodiscard]] int observation_size() const override { return 12; }
  [[nodiscard]] int horizon() const override { return task_.num_loops; }
  void SetConditions(const EpisodeConditions& conditions) override { conditions_ = conditions; }
  Eigen::VectorXd Reset(const Rng& rng) override;
  StepResult Step(const LoopCoefficients& action) override;
  [[nodiscard]] double relative_error() const override { return status_.relative_error; }

 private:
  [[nodiscard]] Rigid3 Truth() const;
  [[nodiscard]] double RewardedError() const;
  [[nodiscard]] RewardTerm InformationTerm(const ExtrinsicStatus& before) const;
  void Record(const TimedMotion& motion, const Rng& noise);
  void Calibrate();

  ExtrinsicTask task_;
  EpisodeConditions conditions_;
  // One episode:
  Rng noise_{0};
  Rig rig_;
  BasePose base_pose_;
  int num_steps_ = 0;
  int num_frames_ = 0;
  Time now_;
  std::vector<BoardView> views_;
  ImuStream imu_;
  double imu_entropy_ = 0.0;
  double boards_per_frame_ = 0.0;
  ExtrinsicStatus status_;
};

}  // namespace calibrato
