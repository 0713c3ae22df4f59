#include "calibrato/mdp/motion_judgement.h"

#include <Eigen/Cholesky>

#include "calibrato/mdp/calibration_status.h"
#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/mdp/recorded_loop.h"

namespace calibrato {
namespace {

constexpr int kMaxIterations = 50;
// No stamp is negative, whatever the time offset.
constexpr Time kStart = Time::FromNanoseconds(1'000'000'000'000);

}  // namespace

MotionJudgement JudgeMotion(Task task, const Rig& rig, const TimedMotion& motion, Fidelity fidelity,
                            DesignCriterion criterion, const Rng& rng) {
  const bool wants_camera = task != Task::kExtrinsic;
  const bool wants_imu = task != Task::kIntrinsic;
  const RecordedLoop recorded = RecordLoop(rig, motion, fidelity, kStart, rng, wants_imu);
  const Camera& truth = rig.cameras.front();
  MotionJudgement judgement;
  ExtrinsicSolve solve;
  solve.criterion = criterion;
  solve.max_iterations = kMaxIterations;
  if (wants_camera) {
    const IntrinsicStatus status =
        CalibrateIntrinsics(FramesThatCount(recorded.views, truth.resolution, rig.board), truth,
                            criterion, kMaxIterations);
    const Eigen::Vector4d error = status.estimate - truth.model.focal_and_centre();
    judgement.stated_loss -= status.information;
    judgement.nees += error.dot(status.covariance.llt().solve(error));
    judgement.nees_dimension += 4;
    judgement.relative_error += status.relative_error;
    solve.camera = status.model;
    solve.camera_covariance = status.model_covariance;
  }
  if (wants_imu) {
    const ExtrinsicStatus status =
        CalibrateExtrinsics(rig, recorded.views, recorded.imu, rig.T_c0_i, solve)
            .value_or(PriorExtrinsicStatus(rig.T_c0_i, criterion));
    const Eigen::Matrix<double, 6, 1> error = rig.T_c0_i.DifferenceTo(status.estimate);
    judgement.stated_loss -= status.information;
    judgement.nees += error.dot(status.covariance.llt().solve(error));
    judgement.nees_dimension += 6;
    judgement.relative_error += status.relative_error;
  }
  if (wants_camera && wants_imu) judgement.stated_loss *= 0.5;
  return judgement;
}

}  // namespace calibrato
