#include "calibrato/mdp/joint_environment.h"

#include <cassert>
#include <utility>

#include "calibrato/mdp/imu_entropy.h"
#include "calibrato/mdp/recorded_loop.h"

namespace calibrato {
namespace {

constexpr double kBonusError = 0.01;  // [-]

}  // namespace

Eigen::VectorXd JointEnvironment::Reset(const Rng& rng) {
  if (task_.fixed_rig) {
    rig_ = *task_.fixed_rig;
  } else {
    Rng rigs = rng.Stream("rig");
    rig_ = DrawRig(task_.rigs, rigs);
  }
  base_pose_ = BasePoseBeforeBoard(rig_);
  noise_ = rng.Stream("noise");
  num_steps_ = 0;
  num_frames_ = 0;
  // No stamp is negative, whatever the time offset.
  now_ = Time::FromNanoseconds(1'000'000'000'000);
  views_.clear();
  counted_views_.clear();
  imu_ = {};
  status_.coverage = {};
  status_.imu_entropy = 0.0;
  status_.boards_per_frame = 0.0;
  status_.intrinsic = PriorIntrinsicStatus(rig_.cameras.front(), task_.criterion);
  status_.extrinsic = PriorExtrinsicStatus(rig_.T_c0_i, task_.criterion);
  bonus_paid_ = false;
  return Observation();
}

void JointEnvironment::Record(const TimedMotion& motion, const Rng& noise) {
  RecordedLoop loop = RecordLoop(rig_, motion, task_.fidelity, now_, noise, /*want_imu=*/true);
  now_ = now_ + Duration::FromSeconds(motion.duration_s());
  num_frames_ += loop.num_frames;
  views_.insert(views_.end(), loop.views.begin(), loop.views.end());
  const Resolution resolution = rig_.cameras.front().resolution;
  for (BoardView& view : FramesThatCount(std::move(loop.views), resolution, rig_.board)) {
    counted_views_.push_back(std::move(view));
  }
  imu_.gyro.insert(imu_.gyro.end(), loop.imu.gyro.begin(), loop.imu.gyro.end());
  imu_.accel.insert(imu_.accel.end(), loop.imu.accel.begin(), loop.imu.accel.end());
  status_.coverage = CoverageOf(counted_views_, resolution);
  status_.imu_entropy = ImuEntropy(imu_);
  status_.boards_per_frame =
      num_frames_ == 0 ? 0.0 : static_cast<double>(views_.size()) / num_frames_;
}

void JointEnvironment::Calibrate() {
  if (!conditions_.calibrate) return;
  const int max_iterations = conditions_.max_iterations.value_or(task_.max_iterations);
  status_.intrinsic =
      CalibrateIntrinsics(counted_views_, rig_.cameras.front(), task_.criterion, max_iterations);
  if (!status_.intrinsic.model) return;
  ExtrinsicSolve solve;
  solve.criterion = task_.criterion;
  solve.max_iterations = max_iterations;
  solve.camera = status_.intrinsic.model;
  solve.camera_covariance = status_.intrinsic.model_covariance;
  if (auto status = CalibrateExtrinsics(rig_, views_, imu_, rig_.T_c0_i, solve)) {
    status_.extrinsic = *status;
  }
}

StepResult JointEnvironment::Step(const LoopCoefficients& action) {
  assert(num_steps_ < horizon());
  const JointRewardWeights& weights = task_.weights;
  Motion motion;
  motion.carrier = task_.carrier;
  motion.base_pose = base_pose_;
  motion.loops.push_back({ScaledAction(action), 5.0});
  // Each loop has noise of its own, whatever became of the loops before it.
  const Rng loop_noise = noise_.Stream("loop", static_cast<uint64_t>(num_steps_));
  ++num_steps_;

  const Status before = status_;
  const auto planned = PlanMotion(motion, rig_);
  const auto* timed = std::get_if<TimedMotion>(&planned);
  if (timed != nullptr) {
    Record(*timed, loop_noise);
    Calibrate();
  }
  const bool bonus =
      timed != nullptr && !bonus_paid_ && status_.intrinsic.relative_error < kBonusError;
  bonus_paid_ = bonus_paid_ || bonus;
  StepResult result;
  result.observation = Observation();
  result.executed = timed != nullptr;
  result.terms = {
      {"coverage", "coverage", status_.coverage.sum() - before.coverage.sum(), weights.coverage},
      {"imu_entropy", "imu_entropy_nat", status_.imu_entropy - before.imu_entropy,
       weights.empirical},
      {"boards_per_frame", "boards_per_frame", status_.boards_per_frame - before.boards_per_frame,
       weights.empirical},
      {"intrinsic_information", "intrinsic_information_nat",
       status_.intrinsic.information - before.intrinsic.information, weights.intrinsic_information},
      {"extrinsic_information", "extrinsic_information_nat",
       status_.extrinsic.information - before.extrinsic.information, weights.extrinsic_information},
      {"intrinsic_error", "intrinsic_relative_error",
       before.intrinsic.relative_error - status_.intrinsic.relative_error, weights.intrinsic_error},
      {"extrinsic_error", "extrinsic_relative_error",
       before.extrinsic.relative_error - status_.extrinsic.relative_error, weights.extrinsic_error},
      {"reprojection", "reprojection_px",
       before.extrinsic.reprojection_px - status_.extrinsic.reprojection_px, weights.reprojection},
      {"path_length", "path_length_m", timed == nullptr ? 0.0 : PathLength(motion),
       -weights.path_length},
      {"accuracy_bonus", "accuracy_bonus", bonus ? 1.0 : 0.0, weights.accuracy_bonus},
      {"refusal", "refusals", timed == nullptr ? 1.0 : 0.0, weights.refusal}};
  result.reward = SumOf(result.terms);
  return result;
}

Eigen::VectorXd JointEnvironment::Observation() const {
  Eigen::VectorXd observation(observation_size());
  observation << ObservationOf(status_.intrinsic, status_.coverage),
      ObservationOf(status_.extrinsic);
  return observation;
}

}  // namespace calibrato
