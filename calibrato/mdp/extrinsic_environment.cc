#include "calibrato/mdp/extrinsic_environment.h"

#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>
#include <numbers>

#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/geometry/rpy.h"
#include "calibrato/mdp/imu_entropy.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/imu_simulation.h"

namespace calibrato {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kPriorRotation = 0.1;      // [rad]
constexpr double kPriorTranslation = 0.01;  // [m]
// What a camera that nobody calibrated to its IMU is off by, before any data [px].
constexpr double kPriorReprojection = 1.0;
constexpr size_t kLeastFrames = 3;

// Of the normalised covariance: 1e-3 rad, 1e-3 m (information.h).
const Vector6d kUnit = Vector6d::Constant(1e-3);

}  // namespace

Vector6d ExtrinsicVector(const Rigid3& T_c_i) {
  Vector6d vector;
  vector << T_c_i.t, RpyFromRotation(T_c_i.R);
  return vector;
}

double RelativeExtrinsicError(const Rigid3& estimate, const Rigid3& truth) {
  Vector6d difference = ExtrinsicVector(estimate) - ExtrinsicVector(truth);
  for (double& angle : difference.tail<3>()) {
    angle = std::remainder(angle, 2.0 * std::numbers::pi);
  }
  return difference.norm() / ExtrinsicVector(truth).norm();
}

Rigid3 PriorMeanExtrinsics() { return {RotationFromRpy({0.0, 0.0, 1.5708}), {0.06, 0.0, -0.1}}; }

Matrix6d PriorExtrinsicsCovariance() {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(kPriorRotation * kPriorRotation),
      Eigen::Vector3d::Constant(kPriorTranslation * kPriorTranslation);
  return variance.asDiagonal();
}

double InformationStatus(DesignCriterion criterion, const Matrix6d& covariance) {
  const double value = EvaluateCriterion(criterion, covariance, kUnit).value;
  return criterion == DesignCriterion::kD ? -value / (2.0 * 6.0) : -0.5 * std::log(value);
}

Eigen::VectorXd ExtrinsicEnvironment::Reset(const Rng& rng) {
  if (task_.fixed_rig) {
    rig_ = *task_.fixed_rig;
  } else {
    Rng rigs = rng.Stream("rig");
    rig_ = DrawRig(task_.rigs, rigs);
  }
  base_pose_ = task_.fixed_rig ? BasePose() : BasePoseBeforeBoard(rig_);
  noise_ = rng.Stream("noise");
  num_steps_ = 0;
  num_frames_ = 0;
  // No stamp is negative, whatever the time offset.
  now_ = Time::FromNanoseconds(1'000'000'000'000);
  views_.clear();
  imu_ = {};
  estimate_ = PriorMeanExtrinsics();
  covariance_ = PriorExtrinsicsCovariance();
  status_ = {.information = InformationStatus(task_.criterion, covariance_),
             .relative_error = RelativeExtrinsicError(estimate_, rig_.T_c0_i),
             .reprojection_px = kPriorReprojection};
  return Observation();
}

void ExtrinsicEnvironment::Record(const TimedMotion& motion, Rng& rng) {
  Rng frame_noise = rng.Stream("frames");
  Rng imu_noise = rng.Stream("imu");
  SimulatedFrames frames = SimulateFrames(rig_, motion, now_, frame_noise);
  SimulatedImu imu = SimulateImu(rig_, motion, now_, imu_noise);
  now_ = now_ + Duration::FromSeconds(motion.duration_s());
  num_frames_ += frames.num_frames;
  for (BoardView& view : frames.views) views_.push_back(std::move(view));
  imu_.gyro.insert(imu_.gyro.end(), imu.stream.gyro.begin(), imu.stream.gyro.end());
  imu_.accel.insert(imu_.accel.end(), imu.stream.accel.begin(), imu.stream.accel.end());
}

void ExtrinsicEnvironment::Calibrate() {
  if (views_.size() < kLeastFrames) return;
  CameraImuProblem problem;
  problem.cameras.push_back({rig_.cameras.front().model, views_, IntrinsicsKnowledge::kExact, {}});
  problem.imus.push_back({imu_, rig_.imu_noise, ImuModelKind::kCalibrated});
  problem.corner_noise_px = rig_.corner_noise.stddev_px;
  CameraImuOptions options;
  options.max_iterations = task_.max_iterations;
  options.reject_outliers = false;
  const CameraImuCalibration result = CalibrateCameraImu(problem, options);
  const bool determined = result.state && result.information.covariance.rows() >= 6 &&
                          result.information.covariance.topLeftCorner<6, 6>().allFinite();
  if (!determined) return;
  estimate_ = result.state->cameras.front().T_c_i;
  covariance_ = result.information.covariance.topLeftCorner<6, 6>();
  status_.information = InformationStatus(task_.criterion, covariance_);
  status_.relative_error = RelativeExtrinsicError(estimate_, rig_.T_c0_i);
  status_.reprojection_px = result.reprojection_rms_px;
}

StepResult ExtrinsicEnvironment::Step(const LoopCoefficients& action) {
  assert(num_steps_ < horizon());
  const ExtrinsicRewardWeights& weights = task_.weights;
  Motion motion;
  motion.carrier = task_.carrier;
  motion.base_pose = base_pose_;
  motion.loops.push_back({ScaledAction(action), 5.0});
  // Each loop has noise of its own, whatever became of the loops before it.
  Rng loop_noise = noise_.Stream("loop", static_cast<uint64_t>(num_steps_));
  ++num_steps_;

  const Status before = status_;
  const auto planned = PlanMotion(motion, rig_);
  const auto* timed = std::get_if<TimedMotion>(&planned);
  if (timed != nullptr) {
    Record(*timed, loop_noise);
    status_.imu_entropy = ImuEntropy(imu_);
    status_.boards_per_frame =
        num_frames_ == 0 ? 0.0 : static_cast<double>(views_.size()) / num_frames_;
    if (task_.calibrate) Calibrate();
  }

  StepResult result;
  result.observation = Observation();
  result.executed = timed != nullptr;
  result.terms = {
      {"imu_entropy", weights.empirical * (status_.imu_entropy - before.imu_entropy)},
      {"boards_per_frame",
       weights.empirical * (status_.boards_per_frame - before.boards_per_frame)},
      {"information", weights.information * (status_.information - before.information)},
      {"relative_error", weights.relative_error * (before.relative_error - status_.relative_error)},
      {"reprojection", weights.reprojection * (before.reprojection_px - status_.reprojection_px)},
      {"path_length", timed == nullptr ? 0.0 : -weights.path_length * PathLength(motion)},
      {"refusal", timed == nullptr ? weights.refusal : 0.0}};
  for (const auto& [name, value] : result.terms) result.reward += value;
  return result;
}

Eigen::VectorXd ExtrinsicEnvironment::Observation() const {
  const Vector6d prior = PriorExtrinsicsCovariance().diagonal().cwiseSqrt();
  const Matrix6d normalised =
      kUnit.cwiseInverse().asDiagonal() * covariance_ * kUnit.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(normalised, Eigen::EigenvaluesOnly);
  Eigen::VectorXd observation(observation_size());
  observation << estimate_.DifferenceTo(PriorMeanExtrinsics()).cwiseQuotient(prior),
      0.5 * solver.eigenvalues().array().log().matrix();
  return observation;
}

}  // namespace calibrato
