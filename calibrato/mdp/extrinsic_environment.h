#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "calibrato/calibration/design_criterion.h"
#include "calibrato/mdp/environment.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {

/// Weights of Eq. 3 for the extrinsic task (paper, Table 5).
struct ExtrinsicRewardWeights {
  double empirical = 1.0;  ///< eta_1, of IMU entropy [1/nat] and of boards per frame [-] alike.
  /// eta_2, of the information: see InformationStatus. The paper's 1e8 belongs to the trace of its
  /// conditional, unnormalised covariance and does not carry over.
  double information = 1.0;
  double relative_error = 1.0;  ///< eta_3, of the fall of the relative error [-].
  double path_length = 1.0;     ///< eta_4 [1/m]
  /// eta_3', of the fall of the reprojection error [1/px], in place of the relative error where the
  /// truth is unknown (appendix C): 0 or, with relative_error 0, 2.
  double reprojection = 0.0;
  double refusal = -1.0;  ///< For an action that the carrier can't make.
};

/// Where the episodes of the extrinsic task take place.
struct ExtrinsicTask {
  Carrier carrier = Carrier::kFree;
  RigDistribution rigs = RigDistribution::kPaper;
  std::optional<Rig> fixed_rig;  ///< Every episode with this one instead.
  ExtrinsicRewardWeights weights;
  DesignCriterion criterion = DesignCriterion::kA;
  /// Of the solver, each time it is called: the paper limits Kalibr to 1 while it trains and to 10
  /// in tests.
  int max_iterations = 50;
  bool calibrate = true;  ///< False: the paper's first stage, with empirical and path terms alone.
};

/// x y z [m] and fixed-axis roll pitch yaw [rad] of T_cam_imu: the paper's theta.
[[nodiscard]] Eigen::Matrix<double, 6, 1> ExtrinsicVector(const Rigid3& T_c_i);

/// ||estimate - truth|| / ||truth|| of these vectors, angles the short way round: the paper's
/// relative error, which mixes metres with radians [-].
[[nodiscard]] double RelativeExtrinsicError(const Rigid3& estimate, const Rigid3& truth);

/// What is known of T_cam_imu before any data: the mean and spread of the paper's Table 4, 0.1 rad
/// and 0.01 m, as covariance of [rotation, translation].
[[nodiscard]] Rigid3 PriorMeanExtrinsics();
[[nodiscard]] Eigen::Matrix<double, 6, 6> PriorExtrinsicsCovariance();

/// How much is known [nats]: minus half the logarithm of the criterion of the normalised marginal
/// covariance (of kD, per parameter). The paper takes minus the trace itself; the increment of that
/// from the prior's 30,300 to a few after one loop drowns all later ones, and a network that
/// predicts it learns nothing else. The logarithm orders calibrations alike, and gives a halved
/// sigma the same reward wherever it happens.
[[nodiscard]] double InformationStatus(DesignCriterion criterion,
                                       const Eigen::Matrix<double, 6, 6>& covariance);

/// The extrinsic task: around the base pose before the board that was drawn (BasePoseBeforeBoard;
/// before a fixed rig's the paper's base pose), three loops, after each of which camera and IMU are
/// calibrated anew from everything recorded so far, the camera's intrinsics being known.
///
/// Observation, 12 numbers: the estimate's difference to the prior mean [rotation, translation] in
/// the prior's sigmas, then half the logarithms of the six eigenvalues, ascending, of the
/// normalised covariance. Before any data, and while the data do not determine the extrinsics
/// (fewer than three frames, not converged, rank-deficient), both are the prior's.
///
/// Reward terms: imu_entropy, boards_per_frame, information, relative_error, reprojection,
/// path_length, refusal.
class ExtrinsicEnvironment final : public Environment {
 public:
  explicit ExtrinsicEnvironment(ExtrinsicTask task) : task_(std::move(task)) {}

  [[nodiscard]] int observation_size() const override { return 12; }
  [[nodiscard]] int horizon() const override { return NumLoops(Task::kExtrinsic); }
  Eigen::VectorXd Reset(const Rng& rng) override;
  StepResult Step(const LoopCoefficients& action) override;
  [[nodiscard]] double relative_error() const override { return status_.relative_error; }

 private:
  // Everything of which increments are rewarded.
  struct Status {
    double imu_entropy = 0.0;
    double boards_per_frame = 0.0;
    double information = 0.0;
    double relative_error = 0.0;
    double reprojection_px = 0.0;
  };
  [[nodiscard]] Eigen::VectorXd Observation() const;
  void Record(const TimedMotion& motion, Rng& rng);
  void Calibrate();

  ExtrinsicTask task_;
  // One episode:
  Rng noise_{0};
  Rig rig_;
  BasePose base_pose_;
  int num_steps_ = 0;
  int num_frames_ = 0;
  Time now_;
  std::vector<BoardView> views_;
  ImuStream imu_;
  Rigid3 estimate_;
  Eigen::Matrix<double, 6, 6> covariance_;
  Status status_;
};

}  // namespace calibrato
