#include "calibrato/mdp/extrinsic_environment.h"

#include <cassert>

#include "calibrato/mdp/imu_entropy.h"
#include "calibrato/mdp/recorded_loop.h"

namespace calibrato {
namespace {

constexpr double kOriginalInformationWeight = 1e7;

}  // namespace

Rigid3 ExtrinsicEnvironment::Truth() const {
  return task_.mistakes.contains(Mistake::kWrongTruth) ? OriginalTruth(rig_.T_c0_i) : rig_.T_c0_i;
}

double ExtrinsicEnvironment::RewardedError() const {
  const bool constant = task_.mistakes.contains(Mistake::kConstantAccuracy);
  return constant && num_steps_ < horizon() ? 1.0 : status_.relative_error;
}

Eigen::VectorXd ExtrinsicEnvironment::Reset(const Rng& rng) {
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
  imu_ = {};
  imu_entropy_ = 0.0;
  boards_per_frame_ = 0.0;
  status_ = PriorExtrinsicStatus(Truth(), task_.criterion);
  return ObservationOf(status_);
}

void ExtrinsicEnvironment::Record(const TimedMotion& motion, const Rng& noise) {
  RecordedLoop loop = RecordLoop(rig_, motion, task_.fidelity, now_, noise, /*want_imu=*/true);
  now_ = now_ + Duration::FromSeconds(motion.duration_s());
  num_frames_ += loop.num_frames;
  for (BoardView& view : loop.views) views_.push_back(std::move(view));
  imu_.gyro.insert(imu_.gyro.end(), loop.imu.gyro.begin(), loop.imu.gyro.end());
  imu_.accel.insert(imu_.accel.end(), loop.imu.accel.begin(), loop.imu.accel.end());
  imu_entropy_ = task_.mistakes.contains(Mistake::kDurationEntropy)
                     ? OriginalImuEntropy(imu_.gyro.size())
                     : ImuEntropy(imu_);
  boards_per_frame_ = num_frames_ == 0 ? 0.0 : static_cast<double>(views_.size()) / num_frames_;
}

void ExtrinsicEnvironment::Calibrate() {
  const bool too_early =
      task_.mistakes.contains(Mistake::kConstantAccuracy) && num_steps_ < horizon();
  if (!conditions_.calibrate || too_early) return;
  ExtrinsicSolve solve;
  solve.criterion = task_.criterion;
  solve.max_iterations = conditions_.max_iterations.value_or(task_.max_iterations);
  solve.mistakes = task_.mistakes;
  if (auto status = CalibrateExtrinsics(rig_, views_, imu_, Truth(), solve)) status_ = *status;
}

RewardTerm ExtrinsicEnvironment::InformationTerm(const ExtrinsicStatus& before) const {
  if (!task_.mistakes.contains(Mistake::kConditionalCovariance)) {
    return {"information", "information_nat", status_.information - before.information,
            task_.weights.information};
  }
  return {"information", "conditional_trace", status_.conditional_trace - before.conditional_trace,
          -kOriginalInformationWeight};
}

StepResult ExtrinsicEnvironment::Step(const LoopCoefficients& action) {
  assert(num_steps_ < horizon());
  const ExtrinsicRewardWeights& weights = task_.weights;
  Motion motion;
  motion.carrier = task_.carrier;
  motion.base_pose = base_pose_;
  motion.loops.push_back({ScaledAction(action), 5.0});
  // Each loop has noise of its own, whatever became of the loops before it.
  const Rng loop_noise = noise_.Stream("loop", static_cast<uint64_t>(num_steps_));
  const ExtrinsicStatus before = status_;
  const double entropy_before = imu_entropy_;
  const double boards_before = boards_per_frame_;
  const double error_before = RewardedError();
  ++num_steps_;

  const auto planned = PlanMotion(motion, rig_);
  const auto* timed = std::get_if<TimedMotion>(&planned);
  StepResult result;
  result.executed = timed != nullptr;
  if (timed == nullptr && task_.mistakes.contains(Mistake::kSilentRefusals)) {
    result.observation = Eigen::VectorXd::Zero(observation_size());
    return result;
  }
  if (timed != nullptr) {
    Record(*timed, loop_noise);
    Calibrate();
  }
  result.observation = ObservationOf(status_);
  result.terms = {
      {"imu_entropy", "imu_entropy_nat", imu_entropy_ - entropy_before, weights.empirical},
      {"boards_per_frame", "boards_per_frame", boards_per_frame_ - boards_before,
       weights.empirical},
      InformationTerm(before),
      {"relative_error", "relative_error", error_before - RewardedError(), weights.relative_error},
      {"reprojection", "reprojection_px", before.reprojection_px - status_.reprojection_px,
       weights.reprojection},
      {"path_length", "path_length_m", timed == nullptr ? 0.0 : PathLength(motion),
       -weights.path_length},
      {"refusal", "refusals", timed == nullptr ? 1.0 : 0.0, weights.refusal}};
  result.reward = SumOf(result.terms);
  return result;
}

}  // namespace calibrato
