#include "calibrato/mdp/motion_judgement.h"

#include <Eigen/Cholesky>
#include <optional>

#include "calibrato/mdp/calibration_status.h"
#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/mdp/recorded_loop.h"

namespace calibrato {
namespace {

constexpr int kMaxIterations = 50;
// No stamp is negative, whatever the time offset.
constexpr Time kStart = Time::FromNanoseconds(1'000'000'000'000);

// What the statuses of one rig's calibrations come to.
class Sum {
 public:
  void Add(const IntrinsicStatus& status, const CameraModel& truth) {
    const Eigen::Vector4d error = status.estimate - truth.focal_and_centre();
    Add(status.information, error.dot(status.covariance.llt().solve(error)), 4,
        status.relative_error);
  }
  void Add(const ExtrinsicStatus& status, const Rigid3& truth) {
    const Eigen::Matrix<double, 6, 1> error = truth.DifferenceTo(status.estimate);
    Add(status.information, error.dot(status.covariance.llt().solve(error)), 6,
        status.relative_error);
  }
  [[nodiscard]] MotionJudgement Judgement() const {
    MotionJudgement mean = sum_;
    mean.stated_loss /= num_tasks_;
    return mean;
  }

 private:
  void Add(double information, double nees, int dimension, double relative_error) {
    sum_.stated_loss -= information;
    sum_.nees += nees;
    sum_.nees_dimension += dimension;
    sum_.relative_error += relative_error;
    ++num_tasks_;
  }

  MotionJudgement sum_;
  int num_tasks_ = 0;
};

}  // namespace

MotionJudgement JudgeNothingLearned(Task task, const Rig& rig, DesignCriterion criterion) {
  Sum sum;
  if (task != Task::kExtrinsic) {
    sum.Add(PriorIntrinsicStatus(rig.cameras.front(), criterion), rig.cameras.front().model);
  }
  if (task != Task::kIntrinsic) sum.Add(PriorExtrinsicStatus(rig.T_c0_i, criterion), rig.T_c0_i);
  return sum.Judgement();
}

MotionJudgement JudgeMotion(Task task, const Rig& rig, const TimedMotion& motion, Fidelity fidelity,
                            DesignCriterion criterion, const Rng& rng) {
  const bool wants_camera = task != Task::kExtrinsic;
  const bool wants_imu = task != Task::kIntrinsic;
  const RecordedLoop recorded = RecordLoop(rig, motion, fidelity, kStart, rng, wants_imu);
  const Camera& truth = rig.cameras.front();
  Sum sum;
  ExtrinsicSolve solve;
  solve.criterion = criterion;
  solve.max_iterations = kMaxIterations;
  if (wants_camera) {
    const IntrinsicStatus status =
        CalibrateIntrinsics(FramesThatCount(recorded.views, truth.resolution, rig.board), truth,
                            criterion, kMaxIterations);
    sum.Add(status, truth.model);
    solve.camera = status.model;
    solve.camera_covariance = status.model_covariance;
  }
  if (wants_imu) {
    // Of the joint task: without a camera there are no extrinsics.
    std::optional<ExtrinsicStatus> status;
    if (!wants_camera || solve.camera) {
      status = CalibrateExtrinsics(rig, recorded.views, recorded.imu, rig.T_c0_i, solve);
    }
    sum.Add(status.value_or(PriorExtrinsicStatus(rig.T_c0_i, criterion)), rig.T_c0_i);
  }
  return sum.Judgement();
}

}  // namespace calibrato
