#include "calibrato/mdp/intrinsic_environment.h"

#include <cassert>
#include <utility>

#include "calibrato/mdp/recorded_loop.h"

namespace calibrato {
namespace {

constexpr double kBonusError = 0.01;  // [-]

}  // namespace

Eigen::VectorXd IntrinsicEnvironment::Reset(const Rng& rng) {
  if (num_steps_ > 0) carried_coverage_ = coverage_.sum();
  if (task_.fixed_rig) {
    rig_ = *task_.fixed_rig;
  } else {
    Rng rigs = rng.Stream("rig");
    rig_ = DrawRig(task_.rigs, rigs);
  }
  base_pose_ = BasePoseBeforeBoard(rig_);
  noise_ = rng.Stream("noise");
  num_steps_ = 0;
  now_ = Time();
  views_.clear();
  coverage_ = {};
  status_ = PriorIntrinsicStatus(rig_.cameras.front(), task_.criterion);
  bonus_paid_ = false;
  return ObservationOf(status_, coverage_);
}

void IntrinsicEnvironment::Record(const TimedMotion& motion, const Rng& noise) {
  const Camera& camera = rig_.cameras.front();
  RecordedLoop loop = RecordLoop(rig_, motion, task_.fidelity, now_, noise, /*want_imu=*/false);
  now_ = now_ + Duration::FromSeconds(motion.duration_s());
  for (BoardView& view : FramesThatCount(std::move(loop.views), camera.resolution, rig_.board)) {
    views_.push_back(std::move(view));
  }
  coverage_ = CoverageOf(views_, camera.resolution);
  const bool lost = task_.mistakes.contains(Mistake::kLostCoverage) && !loop.last_frame_has_board;
  if (lost) coverage_ = {};
  const bool too_early =
      task_.mistakes.contains(Mistake::kConstantAccuracy) && num_steps_ < horizon();
  if (!conditions_.calibrate || too_early) return;
  status_ = CalibrateIntrinsics(views_, camera, task_.criterion,
                                conditions_.max_iterations.value_or(task_.max_iterations));
}

double IntrinsicEnvironment::RewardedError() const {
  const bool constant = task_.mistakes.contains(Mistake::kConstantAccuracy);
  return constant && num_steps_ < horizon() ? 1.0 : status_.relative_error;
}

double IntrinsicEnvironment::carried_over() const {
  return num_steps_ > 0 ? coverage_.sum() : carried_coverage_;
}

StepResult IntrinsicEnvironment::Step(const LoopCoefficients& action) {
  assert(num_steps_ < horizon());
  const IntrinsicRewardWeights& weights = task_.weights;
  Motion motion;
  motion.carrier = task_.carrier;
  motion.base_pose = base_pose_;
  motion.loops.push_back({ScaledAction(action), 5.0});
  // Each loop has noise of its own, whatever became of the loops before it.
  const Rng loop_noise = noise_.Stream("loop", static_cast<uint64_t>(num_steps_));
  const IntrinsicStatus before = status_;
  const double error_before = RewardedError();
  const bool carries = num_steps_ == 0 && task_.mistakes.contains(Mistake::kCarriedCoverage);
  const double coverage_before = carries ? carried_coverage_ : coverage_.sum();
  ++num_steps_;

  const auto planned = PlanMotion(motion, rig_);
  const auto* timed = std::get_if<TimedMotion>(&planned);
  StepResult result;
  result.executed = timed != nullptr;
  if (timed == nullptr && task_.mistakes.contains(Mistake::kSilentRefusals)) {
    result.observation = Eigen::VectorXd::Zero(observation_size());
    return result;
  }
  if (timed != nullptr) Record(*timed, loop_noise);
  const double error = RewardedError();
  const bool bonus = timed != nullptr && !bonus_paid_ && error < kBonusError;
  bonus_paid_ = bonus_paid_ || bonus;
  const double path_length = timed != nullptr ? PathLength(motion) : 0.0;
  result.observation = ObservationOf(status_, coverage_);
  result.terms = {
      {"coverage", "coverage", coverage_.sum() - coverage_before, weights.coverage},
      {"information", "information_nat", status_.information - before.information,
       weights.information},
      {"relative_error", "relative_error", error_before - error, weights.relative_error},
      {"reprojection", "reprojection_px", before.reprojection_px - status_.reprojection_px,
       weights.reprojection},
      {"path_length", "path_length_m", path_length, -weights.path_length},
      {"accuracy_bonus", "accuracy_bonus", bonus ? 1.0 : 0.0, weights.accuracy_bonus},
      {"refusal", "refusals", timed == nullptr ? 1.0 : 0.0, weights.refusal}};
  result.reward = SumOf(result.terms);
  return result;
}

}  // namespace calibrato
