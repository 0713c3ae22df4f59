#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "calibrato/mdp/extrinsic_environment.h"
#include "calibrato/mdp/intrinsic_environment.h"

namespace calibrato {

/// Weights of Eq. 3 for both calibrations in one motion: those of the paper's two tasks together.
/// The path, which both tasks charge, costs the mean of their 0.2 and 1.
struct JointRewardWeights {
  double coverage = 1.0;               ///< Of the sum of the four coverages [-].
  double empirical = 1.0;              ///< Of IMU entropy [1/nat] and of boards per frame [-].
  double intrinsic_information = 0.0;  ///< [1/nat]
  double extrinsic_information = 1.0;  ///< [1/nat]
  double intrinsic_error = 1.0;        ///< Of the fall of the relative error [-].
  double extrinsic_error = 1.0;        ///< Likewise.
  /// Of the fall of the camera-IMU calibration's reprojection error [1/px]: 0 or, with both errors
  /// and the bonus 0, 2.
  double reprojection = 0.0;
  double path_length = 0.6;     ///< [1/m]
  double accuracy_bonus = 5.0;  ///< Once, when the intrinsic error first falls below 1 %.
  double refusal = -1.0;        ///< For an action that the carrier can't make.
};

/// Where the episodes of the joint task take place.
struct JointTask {
  int num_loops = NumLoops(Task::kJoint);  ///< Of an episode, T >= 1.
  Carrier carrier = Carrier::kFree;
  Fidelity fidelity = Fidelity::kFast;
  RigDistribution rigs = RigDistribution::kPaper;
  std::optional<Rig> fixed_rig;  ///< Every episode with this one instead.
  JointRewardWeights weights;
  DesignCriterion criterion = DesignCriterion::kA;
  int max_iterations = 50;  ///< Of each solver, each time it is called; conditions may differ.
};

/// The joint task: four loops, after each of which the camera is calibrated from all frames that
/// count so far, and then camera and IMU from all frames and samples, with the camera as estimated
/// and its covariance for a prior. While the camera is not determined there are no extrinsics
/// either: both stay those of the prior.
///
/// Observation, 20 numbers: the 8 of the intrinsic task, then the 12 of the extrinsic one.
///
/// Reward terms: coverage, imu_entropy, boards_per_frame, intrinsic_information,
/// extrinsic_information, intrinsic_error, extrinsic_error, reprojection, path_length,
/// accuracy_bonus, refusal.
class JointEnvironment final : public Environment {
 public:
  explicit JointEnvironment(JointTask task) : task_(std::move(task)) {}

  [[nodiscard]] std::unique_ptr<Environment> Clone() const override {
    return std::make_unique<JointEnvironment>(*this);
  }
  [[nodiscard]] int observation_size() const override { return 20; }
  [[nodiscard]] int horizon() const override { return task_.num_loops; }
  void SetConditions(const EpisodeConditions& conditions) override { conditions_ = conditions; }
  Eigen::VectorXd Reset(const Rng& rng) override;
  StepResult Step(const LoopCoefficients& action) override;
  /// The mean of both.
  [[nodiscard]] double relative_error() const override {
    return 0.5 * (status_.intrinsic.relative_error + status_.extrinsic.relative_error);
  }

 private:
  // Everything of which increments are rewarded.
  struct Status {
    Coverage coverage;
    double imu_entropy = 0.0;
    double boards_per_frame = 0.0;
    IntrinsicStatus intrinsic;
    ExtrinsicStatus extrinsic;
  };
  [[nodiscard]] Eigen::VectorXd Observation() const;
  void Record(const TimedMotion& motion, const Rng& noise);
  void Calibrate();

  JointTask task_;
  EpisodeConditions conditions_;
  // One episode:
  Rng noise_{0};
  Rig rig_;
  BasePose base_pose_;
  int num_steps_ = 0;
  int num_frames_ = 0;
  Time now_;
  std::vector<BoardView> views_;
  std::vector<BoardView> counted_views_;
  ImuStream imu_;
  Status status_;
  bool bonus_paid_ = false;
};

}  // namespace calibrato
