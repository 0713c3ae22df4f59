#include "calibrato/mdp/calibration_status.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <utility>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/geometry/rpy.h"
#include "calibrato/mdp/extrinsic_problem.h"
#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kMaxFocalSigma = 0.05;     // sigma(f) / f [-]
constexpr double kPriorRotation = 0.1;      // [rad]
constexpr double kPriorTranslation = 0.01;  // [m]
constexpr size_t kLeastFrames = 3;
constexpr double kSlide = 0.03;  // [m]

// Of the normalised covariances (information.h): 1 px; 1e-3 rad and 1e-3 m.
const Eigen::Vector4d kIntrinsicUnit = Eigen::Vector4d::Ones();
const Vector6d kExtrinsicUnit = Vector6d::Constant(1e-3);

Eigen::Matrix4d FocalAndCentreCovariance(const CameraCalibration& calibration) {
  const int first = CameraModel::FocalIndex(calibration.model->name());
  return calibration.covariance.block<4, 4>(first, first);
}

bool IsDetermined(const CameraCalibration& calibration) {
  if (calibration.termination != Termination::kConverged) return false;
  if (calibration.covariance.size() == 0) return false;
  const Eigen::Vector2d f = calibration.model->focal_and_centre().head<2>();
  const Eigen::Vector2d sigma =
      FocalAndCentreCovariance(calibration).diagonal().head<2>().cwiseSqrt();
  return (sigma.array() <= kMaxFocalSigma * f.array()).all();
}

double Status(DesignCriterion criterion, const Eigen::MatrixXd& covariance,
              const Eigen::VectorXd& unit) {
  const double value = EvaluateCriterion(criterion, covariance, unit).value;
  return criterion == DesignCriterion::kD ? -value / (2.0 * static_cast<double>(unit.size()))
                                          : -0.5 * std::log(value);
}

// The original's imu.yaml (docs/differences.md).
ImuNoise SwappedNoise(double rate_hz) {
  return {.rate_hz = rate_hz,
          .accel_noise_density = 0.004,
          .accel_random_walk = 0.006,
          .gyro_noise_density = 3.8785e-5,
          .gyro_random_walk = 3.394e-4};
}

}  // namespace

Eigen::Vector4d PriorIntrinsicsSigma() { return {34.8, 34.8, 10.0, 10.0}; }

IntrinsicStatus PriorIntrinsicStatus(const Camera& truth, DesignCriterion criterion) {
  IntrinsicStatus status;
  status.estimate = PriorMeanIntrinsics();
  status.covariance = PriorIntrinsicsSigma().cwiseAbs2().asDiagonal();
  status.information = IntrinsicInformationStatus(criterion, status.covariance);
  status.relative_error = RelativeIntrinsicError(status.estimate, truth.model.focal_and_centre());
  status.reprojection_px = kPriorReprojectionPx;
  return status;
}

IntrinsicStatus CalibrateIntrinsics(const std::vector<BoardView>& views, const Camera& truth,
                                    DesignCriterion criterion, int max_iterations) {
  IntrinsicStatus status = PriorIntrinsicStatus(truth, criterion);
  if (views.empty()) return status;
  CameraProblem problem;
  problem.model = IntrinsicTaskModel(truth.model);
  problem.resolution = truth.resolution;
  problem.views = views;
  CameraCalibration calibration = CalibrateCamera(problem, max_iterations);
  if (!IsDetermined(calibration)) return status;
  status.estimate = calibration.model->focal_and_centre();
  const Eigen::Matrix4d of_data = FocalAndCentreCovariance(calibration);
  const Eigen::Matrix4d weight = of_data.inverse() + status.covariance.inverse();
  status.covariance = weight.llt().solve(Eigen::Matrix4d::Identity());
  status.information = IntrinsicInformationStatus(criterion, status.covariance);
  status.relative_error = RelativeIntrinsicError(status.estimate, truth.model.focal_and_centre());
  status.reprojection_px = calibration.reprojection_rms_px;
  status.model = std::move(calibration.model);
  status.model_covariance = std::move(calibration.covariance);
  return status;
}

ExtrinsicStatus PriorExtrinsicStatus(const Rigid3& truth, DesignCriterion criterion) {
  ExtrinsicStatus status;
  status.estimate = PriorMeanExtrinsics();
  status.covariance = PriorExtrinsicsCovariance();
  status.information = InformationStatus(criterion, status.covariance);
  status.relative_error = RelativeExtrinsicError(status.estimate, truth);
  status.reprojection_px = kPriorReprojectionPx;
  return status;
}

std::optional<ExtrinsicStatus> CalibrateExtrinsics(const Rig& rig,
                                                   const std::vector<BoardView>& views,
                                                   const ImuStream& imu, const Rigid3& truth,
                                                   const ExtrinsicSolve& solve) {
  if (views.size() < kLeastFrames) return std::nullopt;
  CameraImuProblem problem = ExtrinsicProblem(rig, views, imu);
  problem.corner_noise_px = rig.corner_noise.stddev_px;
  if (solve.mistakes.contains(Mistake::kSwappedNoise)) {
    problem.imus.front().noise = SwappedNoise(rig.imu_noise.rate_hz);
  }
  if (solve.camera) {
    problem.cameras.front().model = *solve.camera;
    problem.cameras.front().intrinsics = IntrinsicsKnowledge::kPrior;
    problem.cameras.front().intrinsics_covariance = solve.camera_covariance;
  }
  CameraImuOptions options;
  options.max_iterations = solve.max_iterations;
  options.reject_outliers = false;
  const CameraImuCalibration result = CalibrateCameraImu(problem, options);
  const bool determined = result.state && result.information.covariance.rows() >= 6 &&
                          result.information.covariance.topLeftCorner<6, 6>().allFinite();
  if (!determined) return std::nullopt;
  ExtrinsicStatus status;
  status.estimate = result.state->cameras.front().T_c_i;
  status.covariance = result.information.covariance.topLeftCorner<6, 6>();
  status.information = InformationStatus(solve.criterion, status.covariance);
  status.conditional_trace = result.information.a_optimality_conditional;
  status.relative_error = RelativeExtrinsicError(status.estimate, truth);
  status.reprojection_px = result.reprojection_rms_px;
  return status;
}

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

double RelativeIntrinsicError(const Eigen::Vector4d& estimate, const Eigen::Vector4d& truth) {
  return (estimate - truth).norm() / truth.norm();
}

Rigid3 PriorMeanExtrinsics() { return {RotationFromRpy({0.0, 0.0, 1.5708}), {0.06, 0.0, -0.1}}; }

Matrix6d PriorExtrinsicsCovariance() {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(kPriorRotation * kPriorRotation),
      Eigen::Vector3d::Constant(kPriorTranslation * kPriorTranslation);
  return variance.asDiagonal();
}

Rigid3 OriginalTruth(const Rigid3& T_c_i) {
  // The slide is along the IMU's y axis; turned with the IMU by the rotation off its mean.
  const Eigen::Vector3d slide_c = PriorMeanExtrinsics().R * Eigen::Vector3d(0.0, -kSlide, 0.0);
  const Eigen::Matrix3d turn = T_c_i.R * PriorMeanExtrinsics().R.transpose();
  return {T_c_i.R, T_c_i.t - turn * slide_c + slide_c};
}

double InformationStatus(DesignCriterion criterion, const Matrix6d& covariance) {
  return Status(criterion, covariance, kExtrinsicUnit);
}

double IntrinsicInformationStatus(DesignCriterion criterion, const Eigen::Matrix4d& covariance) {
  return Status(criterion, covariance, kIntrinsicUnit);
}

Eigen::VectorXd ObservationOf(const IntrinsicStatus& status, const Coverage& coverage) {
  Eigen::VectorXd observation(8);
  observation << status.estimate.cwiseQuotient(PriorMeanIntrinsics()), coverage.x, coverage.y,
      coverage.size, coverage.skew;
  return observation;
}

Eigen::VectorXd ObservationOf(const ExtrinsicStatus& status) {
  const Vector6d prior = PriorExtrinsicsCovariance().diagonal().cwiseSqrt();
  const Matrix6d inverse_unit = kExtrinsicUnit.cwiseInverse().asDiagonal();
  const Matrix6d normalised = inverse_unit * status.covariance * inverse_unit;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(normalised, Eigen::EigenvaluesOnly);
  Eigen::VectorXd observation(12);
  observation << status.estimate.DifferenceTo(PriorMeanExtrinsics()).cwiseQuotient(prior),
      0.5 * solver.eigenvalues().array().log().matrix();
  return observation;
}

}  // namespace calibrato
