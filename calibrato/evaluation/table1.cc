#include "calibrato/evaluation/table1.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrato/base/parallel.h"
#include "calibrato/base/progress.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/prediction_error.h"
#include "calibrato/mdp/intrinsic_environment.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/fast_simulation.h"

namespace calibrato {
namespace {

// Keeps the rigs of trials apart from those of training under the same seed.
constexpr const char* kRigPurpose = "evaluation rig";
constexpr const char* kNoisePurpose = "evaluation noise";
constexpr const char* kMotionPurpose = "evaluation motion";

TimedMotion PlanOrScale(Motion motion, Carrier carrier, const Rig& rig) {
  motion.carrier = carrier;
  auto planned = PlanMotion(motion, rig);
  if (auto* timed = std::get_if<TimedMotion>(&planned)) return std::move(*timed);
  return PlanScaledToFit(motion, rig);
}

std::vector<BoardView> CountedViews(const Rig& rig, const TimedMotion& motion, Rng noise) {
  return FramesThatCount(SimulateFrames(rig, motion, Time(), noise).views,
                         rig.cameras.front().resolution, rig.board);
}

struct NamedTimedMotion {
  std::string policy;
  TimedMotion timed;
};

// What was planned in the paper's scene, before the board of a rig that stands elsewhere.
TimedMotion BeforeBoard(const TimedMotion& timed, const Rig& rig) {
  Motion motion = timed.motion;
  motion.base_pose = BasePoseBeforeBoard(rig, motion.base_pose);
  TimedMotion moved = PlanOrScale(motion, motion.carrier, rig);
  moved.scale *= timed.scale;
  return moved;
}

Trial RunTrial(const Rig& rig, const TimedMotion& motion, const Rng& noise) {
  const Camera& camera = rig.cameras.front();
  Trial trial;
  trial.path_length_m = PathLength(motion.motion);
  trial.path_length_original_m = PathLengthOriginal(motion.motion);
  trial.motion_s = motion.duration_s();
  trial.scale = motion.scale;

  CameraProblem problem;
  problem.model = IntrinsicTaskModel(camera.model);
  problem.resolution = camera.resolution;
  problem.views = CountedViews(rig, motion, noise);
  const CameraCalibration calibration = CalibrateCamera(problem);
  trial.converged = calibration.termination == Termination::kConverged;
  if (!trial.converged) return trial;
  const Eigen::Vector4d truth = camera.model.focal_and_centre();
  const Eigen::Vector4d error = calibration.model->focal_and_centre() - truth;
  const Eigen::Matrix4d covariance = calibration.covariance.topLeftCorner<4, 4>();
  trial.relative_error = RelativeIntrinsicError(calibration.model->focal_and_centre(), truth);
  trial.focal_error_px = error.head<2>().norm() / std::sqrt(2.0);
  trial.prediction_error_px =
      PredictionErrorPx(*calibration.model, camera.model, camera.resolution);
  trial.a_optimality = calibration.information.a_optimality;
  trial.nees = error.dot(covariance.ldlt().solve(error));
  return trial;
}

// The errors of the rigs that both rows calibrated, in pairs.
void SetRatio(const Table1Row& row, const Table1Row& reference, const Rng& rng, double* ratio,
              Interval* interval) {
  std::vector<double> numerator;
  std::vector<double> denominator;
  for (size_t i = 0; i < row.trials.size(); ++i) {
    if (!row.trials[i].converged || !reference.trials[i].converged) continue;
    numerator.push_back(row.trials[i].relative_error);
    denominator.push_back(reference.trials[i].relative_error);
  }
  *ratio = Mean(numerator) / Mean(denominator);
  *interval = BootstrapRatio(numerator, denominator, rng);
}

void Summarise(Table1Row* row, const Rng& rng) {
  std::vector<double> errors;
  for (const Trial& trial : row->trials) {
    if (trial.converged) {
      errors.push_back(trial.relative_error);
    } else {
      ++row->num_failures;
    }
  }
  row->mean_error = Mean(errors);
  row->mean_error_ci95 = BootstrapMean(errors, rng);
  row->median_error = Median(errors);
}

}  // namespace

Table1 EvaluateTable1(const Table1Options& options) {
  const Rng rng(options.seed);
  const auto num_rigs = static_cast<size_t>(options.num_rigs);
  const Rig scene = PaperRig();

  struct RigUnderTrial {
    Rig rig;
    TimedMotion random;
  };
  const auto rigs = ParallelMap<RigUnderTrial>(num_rigs, [&](size_t i) {
    Rng draw_rig = rng.Stream(kRigPurpose, i);
    Rng draw_motion = rng.Stream(kMotionPurpose, i);
    RigUnderTrial trial{DrawRig(options.rigs, draw_rig), {}};
    Motion random = RandomMotion(Task::kIntrinsic, draw_motion);
    random.base_pose = BasePoseBeforeBoard(trial.rig);
    trial.random = PlanOrScale(random, options.carrier, trial.rig);
    return trial;
  });
  std::vector<double> random_paths;
  for (const RigUnderTrial& trial : rigs) random_paths.push_back(PathLength(trial.random.motion));
  const double random_path = Mean(random_paths);

  // What is the same for all rigs is planned once, in the nominal scene: planning sees the rig only
  // through the board's place in view. Before boards of other places it is planned anew.
  std::vector<NamedTimedMotion> fixed = {
      {"handcrafted", PlanOrScale(HandcraftedMotion(Task::kIntrinsic), options.carrier, scene)}};
  for (const NamedMotion& named : options.motions) {
    fixed.push_back({named.policy, PlanOrScale(named.motion, options.carrier, scene)});
    const double path = PathLength(fixed.back().timed.motion);
    if (!(path > random_path)) continue;
    Motion shorter = fixed.back().timed.motion;
    for (Loop& loop : shorter.loops) loop.coefficients *= random_path / path;
    fixed.push_back(
        {named.policy + " at random's path", PlanOrScale(shorter, options.carrier, scene)});
  }

  Table1 table{options, std::vector<Table1Row>(1 + fixed.size())};
  table.rows[0].policy = "random";
  for (size_t k = 0; k < fixed.size(); ++k) table.rows[k + 1].policy = fixed[k].policy;

  Progress progress("evaluating", options.num_rigs);
  const auto outcomes = ParallelMap<std::vector<Trial>>(num_rigs, [&](size_t i) {
    const Rng noise = rng.Stream(kNoisePurpose, i);
    std::vector<Trial> trials = {RunTrial(rigs[i].rig, rigs[i].random, noise)};
    for (const NamedTimedMotion& motion : fixed) {
      const Rig& rig = rigs[i].rig;
      trials.push_back(IsPapersScene(options.rigs)
                           ? RunTrial(rig, motion.timed, noise)
                           : RunTrial(rig, BeforeBoard(motion.timed, rig), noise));
    }
    progress.Advance();
    return trials;
  });

  for (size_t k = 0; k < table.rows.size(); ++k) {
    Table1Row& row = table.rows[k];
    for (size_t i = 0; i < num_rigs; ++i) {
      row.trials.push_back(outcomes[i][k]);
      row.scale = std::min(row.scale, outcomes[i][k].scale);
    }
    row.example = k == 0 ? rigs[0].random : fixed[k - 1].timed;
    row.example_views = CountedViews(scene, row.example, rng.Stream(kNoisePurpose, 0));
    Summarise(&row, rng.Stream("bootstrap", k));
  }
  for (size_t k = 0; k < table.rows.size(); ++k) {
    Table1Row& row = table.rows[k];
    SetRatio(row, table.rows[1], rng.Stream("bootstrap ratio to handcrafted", k),
             &row.ratio_to_handcrafted, &row.ratio_ci95);
    SetRatio(row, table.rows[0], rng.Stream("bootstrap ratio to random", k), &row.ratio_to_random,
             &row.ratio_to_random_ci95);
  }
  return table;
}

}  // namespace calibrato
