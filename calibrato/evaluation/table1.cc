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
                         rig.cameras.front().resolution);
}

Trial RunTrial(const Rig& rig, const TimedMotion& motion, const Rng& noise) {
  const Camera& camera = rig.cameras.front();
  Trial trial;
  trial.path_length_m = PathLength(motion.motion);
  trial.path_length_original_m = PathLengthOriginal(motion.motion);
  trial.motion_s = motion.duration_s();

  CameraProblem problem;
  problem.model = kIntrinsicTaskModel;
  problem.resolution = camera.resolution;
  problem.views = CountedViews(rig, motion, noise);
  const CameraCalibration calibration = CalibrateCamera(problem);
  trial.converged = calibration.termination == Termination::kConverged;
  if (!trial.converged) return trial;
  const Eigen::Vector4d truth = camera.model.intrinsics();
  const Eigen::Vector4d error = calibration.model->intrinsics() - truth;
  const Eigen::Matrix4d covariance = calibration.covariance.topLeftCorner<4, 4>();
  trial.relative_error = RelativeIntrinsicError(calibration.model->intrinsics(), truth);
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

  // What is fixed is planned once, in the nominal scene; planning sees the rig only through the
  // board's place in view.
  std::vector<NamedMotion> fixed = {{"handcrafted", HandcraftedMotion(Task::kIntrinsic)}};
  fixed.insert(fixed.end(), options.motions.begin(), options.motions.end());
  std::vector<TimedMotion> planned;
  for (const NamedMotion& named : fixed) {
    planned.push_back(PlanOrScale(named.motion, options.carrier, scene));
  }
  const auto random_motion = [&](size_t i, const Rig& rig) {
    Rng draw = rng.Stream(kMotionPurpose, i);
    return PlanOrScale(RandomMotion(Task::kIntrinsic, draw), options.carrier, rig);
  };

  Table1 table{options, std::vector<Table1Row>(1 + fixed.size())};
  table.rows[0].policy = "random";
  for (size_t k = 0; k < fixed.size(); ++k) table.rows[k + 1].policy = fixed[k].policy;

  struct RigTrials {
    std::vector<Trial> trials;  // one a row
    double random_scale = 1.0;
  };
  Progress progress("evaluating", options.num_rigs);
  const auto outcomes = ParallelMap<RigTrials>(num_rigs, [&](size_t i) {
    Rng rigs = rng.Stream(kRigPurpose, i);
    const Rig rig = DrawRig(options.rigs, rigs);
    const Rng noise = rng.Stream(kNoisePurpose, i);
    RigTrials outcome;
    const TimedMotion random = random_motion(i, rig);
    outcome.random_scale = random.scale;
    outcome.trials.push_back(RunTrial(rig, random, noise));
    for (const TimedMotion& motion : planned)
      outcome.trials.push_back(RunTrial(rig, motion, noise));
    progress.Advance();
    return outcome;
  });

  for (size_t k = 0; k < table.rows.size(); ++k) {
    Table1Row& row = table.rows[k];
    for (const RigTrials& outcome : outcomes) {
      row.trials.push_back(outcome.trials[k]);
      if (k == 0) row.scale = std::min(row.scale, outcome.random_scale);
    }
    row.example = k == 0 ? random_motion(0, scene) : planned[k - 1];
    if (k > 0) row.scale = row.example.scale;
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
