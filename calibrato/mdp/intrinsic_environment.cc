#include "calibrato/mdp/intrinsic_environment.h"

#include <cassert>
#include <set>

namespace calibrato {
namespace {

constexpr double kBorderPx = 8.0;
constexpr int kFewestCorners = 4;        // determine a pose
constexpr double kBonusError = 0.01;     // [-]
constexpr double kMaxFocalSigma = 0.05;  // sigma(f) / f [-]

// Weak calibrations are the rule after the first loop; a hundred iterations on them are wasted.
constexpr int kMaxIterations = 50;

bool IsDetermined(const CameraCalibration& calibration) {
  if (calibration.termination != Termination::kConverged) return false;
  const Eigen::Vector2d f = calibration.model->focal_and_centre().head<2>();
  const Eigen::Vector2d sigma = calibration.covariance.diagonal().head<2>().cwiseSqrt();
  return (sigma.array() <= kMaxFocalSigma * f.array()).all();
}

}  // namespace

std::string IntrinsicTaskModel(const CameraModel& lens) {
  const bool is_pinhole =
      lens.name().starts_with("pinhole-radtan") || lens.name() == "pinhole-none";
  return is_pinhole ? kIntrinsicTaskModel : std::string(lens.name());
}

std::vector<BoardView> FramesThatCount(std::vector<BoardView> views, Resolution resolution,
                                       const Board& board) {
  const Eigen::Array2d high(resolution.width - 1 - kBorderPx, resolution.height - 1 - kBorderPx);
  const int points_per_part = PointsPerPart(board);
  for (BoardView& view : views) {
    std::set<int> broken_parts;
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      const Eigen::Array2d pixel = view.pixels.col(k);
      const bool is_inside = (pixel >= kBorderPx).all() && (pixel <= high).all();
      if (!is_inside) broken_parts.insert(view.corner_ids[k] / points_per_part);
    }
    if (broken_parts.empty()) continue;
    std::vector<Eigen::Index> kept;
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      if (!broken_parts.contains(view.corner_ids[k] / points_per_part)) kept.push_back(k);
    }
    view.corner_ids = [&] {
      std::vector<int> ids;
      for (const Eigen::Index k : kept) ids.push_back(view.corner_ids[k]);
      return ids;
    }();
    view.pixels = Eigen::Matrix2Xd(view.pixels(Eigen::all, kept));
    view.points_g = Eigen::Matrix3Xd(view.points_g(Eigen::all, kept));
  }
  std::erase_if(views, [](const BoardView& view) { return view.num_corners() < kFewestCorners; });
  return views;
}

double RelativeIntrinsicError(const Eigen::Vector4d& estimate, const Eigen::Vector4d& truth) {
  return (estimate - truth).norm() / truth.norm();
}

Eigen::VectorXd IntrinsicEnvironment::Reset(const Rng& rng) {
  if (task_.fixed_rig) {
    rig_ = *task_.fixed_rig;
  } else {
    Rng rigs = rng.Stream("rig");
    rig_ = DrawRig(task_.rigs, rigs);
  }
  base_pose_ = task_.fixed_rig ? BasePose() : BasePoseBeforeBoard(rig_);
  noise_ = rng.Stream("noise");
  num_steps_ = 0;
  now_ = Time();
  views_.clear();
  coverage_ = {};
  estimate_ = PriorMeanIntrinsics();
  relative_error_ =
      RelativeIntrinsicError(estimate_, rig_.cameras.front().model.focal_and_centre());
  bonus_paid_ = false;
  return Observation();
}

StepResult IntrinsicEnvironment::Step(const LoopCoefficients& action) {
  assert(num_steps_ < horizon());
  const IntrinsicRewardWeights& weights = task_.weights;
  Motion motion;
  motion.carrier = task_.carrier;
  motion.base_pose = base_pose_;
  motion.loops.push_back({ScaledAction(action), 5.0});
  // Each loop has noise of its own, whatever became of the loops before it.
  Rng loop_noise = noise_.Stream("loop", static_cast<uint64_t>(num_steps_));
  ++num_steps_;

  const auto planned = PlanMotion(motion, rig_);
  double coverage_gain = 0.0;
  double error_fall = 0.0;
  double path_length = 0.0;
  double bonus = 0.0;
  const auto* timed = std::get_if<TimedMotion>(&planned);
  if (timed != nullptr) {
    const Camera& camera = rig_.cameras.front();
    SimulatedFrames frames = SimulateFrames(rig_, *timed, now_, loop_noise);
    now_ = now_ + Duration::FromSeconds(timed->duration_s());
    for (BoardView& view :
         FramesThatCount(std::move(frames.views), camera.resolution, rig_.board)) {
      views_.push_back(std::move(view));
    }
    const double coverage_before = coverage_.sum();
    const double error_before = relative_error_;
    CameraProblem problem;
    problem.model = IntrinsicTaskModel(camera.model);
    problem.resolution = camera.resolution;
    problem.views = views_;
    const CameraCalibration calibration = CalibrateCamera(problem, kMaxIterations);
    coverage_ = calibration.coverage;
    estimate_ =
        IsDetermined(calibration) ? calibration.model->focal_and_centre() : PriorMeanIntrinsics();
    relative_error_ = RelativeIntrinsicError(estimate_, camera.model.focal_and_centre());
    coverage_gain = coverage_.sum() - coverage_before;
    error_fall = error_before - relative_error_;
    path_length = PathLength(motion);
    if (!bonus_paid_ && relative_error_ < kBonusError) {
      bonus_paid_ = true;
      bonus = weights.accuracy_bonus;
    }
  }

  StepResult result;
  result.observation = Observation();
  result.executed = timed != nullptr;
  result.terms = {{"coverage", weights.coverage * coverage_gain},
                  {"relative_error", weights.relative_error * error_fall},
                  {"path_length", -weights.path_length * path_length},
                  {"accuracy_bonus", bonus},
                  {"refusal", result.executed ? 0.0 : weights.refusal}};
  for (const auto& [name, value] : result.terms) result.reward += value;
  return result;
}

Eigen::VectorXd IntrinsicEnvironment::Observation() const {
  Eigen::VectorXd observation(8);
  observation << estimate_.cwiseQuotient(PriorMeanIntrinsics()), coverage_.x, coverage_.y,
      coverage_.size, coverage_.skew;
  return observation;
}

}  // namespace calibrato
