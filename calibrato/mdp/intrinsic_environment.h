#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/mdp/environment.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {

/// Weights of Eq. 3 for the intrinsic task (paper, Table 5), and the two decisions that the paper
/// leaves open (docs/differences.md).
struct IntrinsicRewardWeights {
  double coverage = 1.0;        ///< eta_1, of the sum of the four coverages [-].
  double relative_error = 1.0;  ///< eta_3, of the fall of the relative error [-].
  double path_length = 0.2;     ///< eta_4 [1/m]
  double accuracy_bonus = 5.0;  ///< Once, when the relative error first falls below 1 %.
  double refusal = -1.0;        ///< For an action that the carrier can't make.
};

/// Where the episodes of the intrinsic task take place.
struct IntrinsicTask {
  Carrier carrier = Carrier::kFree;
  RigDistribution rigs = RigDistribution::kPaper;
  std::optional<Rig> fixed_rig;  ///< Every episode with this one instead.
  IntrinsicRewardWeights weights;
};

/// The camera model that the intrinsic task estimates: OpenCV's default, as in the paper.
inline constexpr const char* kIntrinsicTaskModel = "pinhole-radtan5";

/// ... of this camera: the rig's own where it is a fisheye.
[[nodiscard]] std::string IntrinsicTaskModel(const CameraModel& lens);

/// Frames that count in the intrinsic task: every corner at least 8 px inside the image. Of an
/// AprilGrid the tags count, and of a ChArUco board the corners, that are; a frame of fewer than
/// four corners does not.
[[nodiscard]] std::vector<BoardView> FramesThatCount(std::vector<BoardView> views,
                                                     Resolution resolution, const Board& board);

/// ||[fu fv pu pv] - truth|| / ||truth||: the paper's relative error [-].
[[nodiscard]] double RelativeIntrinsicError(const Eigen::Vector4d& estimate,
                                            const Eigen::Vector4d& truth);

/// The intrinsic task: around the base pose before the board that was drawn (BasePoseBeforeBoard;
/// before a fixed rig's the paper's base pose), four loops, after each of which the camera is
/// calibrated anew from all frames that count so far.
///
/// Observation, 8 numbers: the estimate of fu fv pu pv over its prior mean, then the progress of X,
/// Y, size and skew. Before any data, and while the data do not determine the camera (fewer than
/// three frames, not converged, rank-deficient, or sigma(f) / f above 5 %), the estimate is the
/// prior mean.
///
/// Reward terms: coverage, relative_error, path_length, accuracy_bonus, refusal.
class IntrinsicEnvironment final : public Environment {
 public:
  explicit IntrinsicEnvironment(IntrinsicTask task) : task_(std::move(task)) {}

  [[nodiscard]] int observation_size() const override { return 8; }
  [[nodiscard]] int horizon() const override { return NumLoops(Task::kIntrinsic); }
  Eigen::VectorXd Reset(const Rng& rng) override;
  StepResult Step(const LoopCoefficients& action) override;
  [[nodiscard]] double relative_error() const override { return relative_error_; }

 private:
  [[nodiscard]] Eigen::VectorXd Observation() const;

  IntrinsicTask task_;
  // One episode:
  Rng noise_{0};
  Rig rig_;
  BasePose base_pose_;
  int num_steps_ = 0;
  Time now_;
  std::vector<BoardView> views_;
  Coverage coverage_;
  Eigen::Vector4d estimate_ = Eigen::Vector4d::Zero();
  double relative_error_ = 0.0;
  bool bonus_paid_ = false;
};

}  // namespace calibrato
