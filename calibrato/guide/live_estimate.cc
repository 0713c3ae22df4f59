#include "calibrato/guide/live_estimate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/expected_extrinsics.h"

namespace calibrato {
namespace {

// What is known of any camera before it is seen.
constexpr double kFocalOverWidth = 0.9;
constexpr double kFocalShare = 0.3;
constexpr double kCentreShare = 0.05;  // Of the width.
constexpr double kShape = 0.3;         // Of distortion, xi, alpha, beta.
// ... and of any rig.
constexpr double kRotation = 1.0;      // [rad]
constexpr double kTranslation = 0.2;   // [m]
constexpr double kTimeOffset = 0.05;   // [s]
constexpr double kGravityAngle = 0.5;  // [rad]
// With less a solve has nothing to go by.
constexpr size_t kLeastViews = 10;
constexpr double kLeastDuration = 2.5;  // [s]

CameraModel GuessedCamera(const GuideProblem& problem) {
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(CameraModel::NumParameters(problem.model));
  const auto names = CameraModel::ParameterNames(problem.model);
  const double f = kFocalOverWidth * problem.resolution.width;
  for (size_t k = 0; k < names.size(); ++k) {
    auto& value = parameters(static_cast<Eigen::Index>(k));
    if (names[k] == "fu" || names[k] == "fv") value = f;
    if (names[k] == "pu") value = 0.5 * (problem.resolution.width - 1);
    if (names[k] == "pv") value = 0.5 * (problem.resolution.height - 1);
    if (names[k] == "beta") value = 1.0;  // With alpha = xi = 0 every model is a pinhole.
  }
  return {problem.model, parameters};
}

Eigen::MatrixXd KnowledgeOfAnyCamera(const GuideProblem& problem, const CameraModel& camera) {
  const Eigen::Index n = camera.num_parameters();
  const int focal = CameraModel::FocalIndex(camera.name());
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(n, kShape);
  sigma.segment<2>(focal).setConstant(kFocalShare * kFocalOverWidth * problem.resolution.width);
  sigma.segment<2>(focal + 2).setConstant(kCentreShare * problem.resolution.width);
  return sigma.array().square().inverse().matrix().asDiagonal();
}

Eigen::MatrixXd KnowledgeOfAnyRig() {
  Eigen::Matrix<double, 9, 1> sigma;
  sigma << Eigen::Vector3d::Constant(kRotation), Eigen::Vector3d::Constant(kTranslation),
      kTimeOffset, kGravityAngle, kGravityAngle;
  return sigma.array().square().inverse().matrix().asDiagonal();
}

Eigen::MatrixXd KnowledgeBefore(const GuideProblem& problem, const CameraModel& camera) {
  const KnowledgeLayout layout = LayoutOf(problem);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(layout.size(), layout.size());
  if (layout.has_imu) {
    information.topLeftCorner(layout.parameters(), layout.parameters()) = KnowledgeOfAnyRig();
  }
  if (layout.num_parameters > 0) {
    information.bottomRightCorner(layout.num_parameters, layout.num_parameters) =
        KnowledgeOfAnyCamera(problem, camera);
  }
  return information;
}

// The inverse of a covariance whose parameters are of very different size.
Eigen::MatrixXd InverseOf(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::Index n = covariance.rows();
  return scale.asDiagonal() * correlation.ldlt().solve(Eigen::MatrixXd::Identity(n, n)) *
         scale.asDiagonal();
}

// Where these names stand; nothing unless all of them do.
std::optional<std::vector<int>> PlacesOf(const std::vector<std::string>& wanted,
                                         const std::vector<std::string>& names) {
  std::vector<int> places;
  for (const std::string& name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return std::nullopt;
    places.push_back(static_cast<int>(found - names.begin()));
  }
  return places;
}

void EstimateCamera(const GuideProblem& problem, const GuideData& data, LiveEstimate* estimate) {
  if (data.views.size() < kLeastViews) return;
  CameraProblem camera;
  camera.model = problem.model;
  camera.resolution = problem.resolution;
  camera.views = data.views;
  const CameraCalibration calibration = CalibrateCamera(camera);
  if (calibration.termination != Termination::kConverged || !calibration.model) return;
  if (calibration.covariance.size() == 0 || !calibration.covariance.allFinite()) return;
  estimate->camera = *calibration.model;
  estimate->corner_noise_px = calibration.noise_stddev_px;
  estimate->information = KnowledgeBefore(problem, estimate->camera);
  const int n = estimate->camera.num_parameters();
  estimate->information.bottomRightCorner(n, n) += InverseOf(calibration.covariance);
  estimate->camera_is_measured = true;
}

// From angles of the estimator's gravity to those of GravityDirections: orthogonal.
Eigen::Matrix2d GravityAngles(const Eigen::Vector3d& gravity_g) {
  const Eigen::Vector3d down = gravity_g.normalized();
  const Eigen::Matrix<double, 3, 2> axes = GravityTangent(gravity_g);
  Eigen::Matrix<double, 3, 2> moved;
  moved << axes.col(0).cross(down), axes.col(1).cross(down);
  return GravityDirections(gravity_g).transpose() * moved;
}

void EstimateExtrinsics(const GuideProblem& problem, const GuideData& data,
                        LiveEstimate* estimate) {
  if (data.views.size() < kLeastViews || data.imu.gyro.empty() || data.imu.accel.empty()) return;
  if ((data.imu.gyro.back().stamp - data.imu.gyro.front().stamp).seconds() < kLeastDuration) return;
  if (!problem.known_camera && !estimate->camera_is_measured) return;
  CameraImuProblem rig;
  rig.gravity = problem.gravity;
  rig.cameras.push_back(
      {estimate->camera,
       data.views,
       problem.known_camera ? IntrinsicsKnowledge::kExact : IntrinsicsKnowledge::kUnknown,
       {}});
  rig.imus.push_back({data.imu, *problem.imu, ImuModelKind::kCalibrated});
  CameraImuOptions options;
  options.max_iterations = 40;
  const CameraImuCalibration calibration = CalibrateCameraImu(rig, options);
  if (calibration.termination != Termination::kConverged || !calibration.state) return;
  const CameraImuInformation& information = calibration.information;
  const CameraCalibrationState& camera = calibration.state->cameras.front();
  std::vector<std::string> wanted = {"cam0.rot_x",       "cam0.rot_y", "cam0.rot_z",
                                     "cam0.pos_x",       "cam0.pos_y", "cam0.pos_z",
                                     "cam0.time_offset", "gravity_1",  "gravity_2"};
  if (!problem.known_camera) {
    for (const std::string& name : CameraModel::ParameterNames(camera.model.name())) {
      wanted.push_back("cam0." + name);
    }
  }
  const auto places = PlacesOf(wanted, information.names);
  if (!places || information.covariance.size() == 0) return;
  const Eigen::MatrixXd covariance = information.covariance(*places, *places);
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0.0)) return;
  Eigen::MatrixXd to_directions =
      Eigen::MatrixXd::Identity(LayoutOf(problem).size(), LayoutOf(problem).size());
  constexpr int kGravity = 7;
  to_directions.block<2, 2>(kGravity, kGravity) = GravityAngles(calibration.state->gravity_g);
  const Eigen::MatrixXd known = KnowledgeBefore(problem, camera.model) +
                                to_directions * InverseOf(covariance) * to_directions.transpose();
  if (!known.allFinite()) return;
  estimate->camera = camera.model;
  estimate->T_c_i = camera.T_c_i;
  estimate->time_offset_s = camera.time_offset_s;
  estimate->gravity_g = calibration.state->gravity_g;
  estimate->corner_noise_px = calibration.weights.corner_noise_px;
  estimate->information = known;
  estimate->extrinsics_are_measured = true;
}

}  // namespace

bool LiveEstimate::is_reached() const {
  return std::all_of(progress.begin(), progress.end(),
                     [](const ParameterProgress& parameter) { return parameter.is_reached(); });
}

KnowledgeLayout LayoutOf(const GuideProblem& problem) {
  return {problem.imu.has_value(),
          problem.known_camera ? 0 : CameraModel::NumParameters(problem.model)};
}

LiveEstimate GuessBefore(const GuideProblem& problem) {
  LiveEstimate guess{problem.known_camera ? *problem.known_camera : GuessedCamera(problem)};
  guess.gravity_g *= problem.gravity / kStandardGravity;
  guess.information = KnowledgeBefore(problem, guess.camera);
  guess.progress = ProgressOf(guess.information, LayoutOf(problem), guess.camera, problem.wanted);
  return guess;
}

LiveEstimate EstimateSoFar(const GuideProblem& problem, const GuideData& data) {
  LiveEstimate estimate = GuessBefore(problem);
  if (!problem.known_camera) EstimateCamera(problem, data, &estimate);
  if (problem.imu) EstimateExtrinsics(problem, data, &estimate);
  estimate.progress =
      ProgressOf(estimate.information, LayoutOf(problem), estimate.camera, problem.wanted);
  return estimate;
}

}  // namespace calibrato
