#include "calibrato/simulation/rig_distribution.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/rpy.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/sensors/effects.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

constexpr double kFieldOfViewMean = 1.0;     // [rad]
constexpr double kFieldOfViewStddev = 0.05;  // [rad]
constexpr double kDistortionStddev = 0.1;    // [-]
constexpr double kTranslationStddev = 0.01;  // [m]
constexpr double kRotationStddev = 0.1;      // [rad]
constexpr double kDegree = std::numbers::pi / 180.0;

constexpr RigDistribution kDistributions[] = {
    RigDistribution::kPaper, RigDistribution::kPaperUndistorted, RigDistribution::kBroad,
    RigDistribution::kPaperReal, RigDistribution::kBroadReal};

Vector3d Draw(const Vector3d& mean, double stddev, Rng& rng) {
  Vector3d x = mean;
  for (int i = 0; i < 3; ++i) x(i) += stddev * rng.Normal();
  return x;
}

Vector3d DrawUniform(double half_width, Rng& rng) {
  Vector3d x;
  for (double& coordinate : x) coordinate = rng.Uniform(-half_width, half_width);
  return x;
}

double DrawLogUniform(double low, double high, Rng& rng) {
  return low * std::pow(high / low, rng.Uniform());
}

void DrawPapersLens(bool is_distorted, Camera* camera, Rng& rng) {
  const double f = FocalLengthFromFieldOfView(rng.Normal(kFieldOfViewMean, kFieldOfViewStddev),
                                              camera->resolution.width);
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(9);
  parameters.head<4>() << f, f, camera->model.focal_and_centre().tail<2>();
  camera->model = CameraModel("pinhole-radtan5", parameters);
  if (!is_distorted) return;
  do {
    const Vector3d k = Draw(Vector3d::Zero(), kDistortionStddev, rng);
    parameters(4) = k(0);
    parameters(5) = k(1);
    parameters(8) = k(2);
    camera->model = CameraModel("pinhole-radtan5", parameters);
  } while (!CoversImage(camera->model, camera->resolution));
}

void DrawBroadLens(Camera* camera, Rng& rng) {
  constexpr double kShareOfFisheyes = 0.25;
  constexpr double kCentreStddev = 5.0;       // [px]
  constexpr double kAspectStddev = 1e-3;      // [-]
  constexpr double kTangentialStddev = 5e-4;  // [-]
  constexpr double kFisheyeStddev = 0.01;     // [-]
  const Eigen::Vector2d papers_centre = camera->model.focal_and_centre().tail<2>();
  const int width = camera->resolution.width;
  const bool is_fisheye = rng.Uniform() < kShareOfFisheyes;
  const double hfov = is_fisheye ? rng.Uniform(1.6, 2.4) : rng.Uniform(0.7, 1.6);
  // A fisheye's radius is its focal length times the angle.
  const double f = is_fisheye ? width / hfov : FocalLengthFromFieldOfView(hfov, width);
  do {
    Eigen::VectorXd parameters(is_fisheye ? 8 : 9);
    parameters(0) = f;
    parameters(1) = f * rng.Normal(1.0, kAspectStddev);
    parameters(2) = rng.Normal(papers_centre.x(), kCentreStddev);
    parameters(3) = rng.Normal(papers_centre.y(), kCentreStddev);
    for (int i = 4; i < parameters.size(); ++i) {
      const bool is_tangential = i == 6 || i == 7;
      const double pinhole_stddev = is_tangential ? kTangentialStddev : kDistortionStddev;
      parameters(i) = rng.Normal(0.0, is_fisheye ? kFisheyeStddev : pinhole_stddev);
    }
    camera->model = CameraModel(is_fisheye ? "pinhole-equi" : "pinhole-radtan5", parameters);
  } while (!CoversImage(camera->model, camera->resolution));
}

void DrawBroadScene(Rig* rig, Rng& rng) {
  // As it stands, the paper's checkerboard has x to the right and y up, as an AprilGrid has.
  Vector3d middle_w = rig->T_w_g * BoardCentre(rig->board);
  if (rng.Uniform() < 0.5) rig->board = AprilGrid{6, 6, 0.088, 0.3};
  middle_w += DrawUniform(0.05, rng);
  rig->T_w_g.R *= RotationFromRpy(DrawUniform(10.0 * kDegree, rng));
  rig->T_w_g.t = middle_w - rig->T_w_g.R * BoardCentre(rig->board);
  rig->T_e_c0.t += DrawUniform(0.02, rng);
  rig->T_e_c0.R *= RotationFromRpy(DrawUniform(5.0 * kDegree, rng));
}

void DrawBroadImu(Rig* rig, Rng& rng) {
  const double grade = DrawLogUniform(1.0, 10.0, rng);
  for (double* figure : {&rig->imu_noise.accel_noise_density, &rig->imu_noise.accel_random_walk,
                         &rig->imu_noise.gyro_noise_density, &rig->imu_noise.gyro_random_walk}) {
    *figure *= grade * DrawLogUniform(0.5, 2.0, rng);
  }
  rig->imu_disturbances.gyro_bias = Draw(Vector3d::Zero(), 0.01, rng);
  rig->imu_disturbances.accel_bias = Draw(Vector3d::Zero(), 0.1, rng);
  rig->time_offset_i_c = Duration::FromSeconds(rng.Uniform(-0.02, 0.02));
}

bool IsBroad(RigDistribution distribution) {
  return distribution == RigDistribution::kBroad || distribution == RigDistribution::kBroadReal;
}

Vector3d DirectionOfBoard(const Rig& rig, const Rigid3& T_b_e) {
  const Vector3d centre_c0 =
      (ArmBaseInWorld() * T_b_e * rig.T_e_c0).Inverse() * (rig.T_w_g * BoardCentre(rig.board));
  constexpr double kTooNear = 0.01;  // [m]
  if (!(centre_c0.norm() > kTooNear)) {
    throw InputError({"the board is where the camera is", "", "their distance is below 1 cm",
                      "check T_w_g and T_e_c0 of the rig"});
  }
  return centre_c0.normalized();
}

}  // namespace

std::string RigDistributionName(RigDistribution distribution) {
  switch (distribution) {
    case RigDistribution::kPaper:
      return "paper";
    case RigDistribution::kPaperUndistorted:
      return "paper-undistorted";
    case RigDistribution::kBroad:
      return "broad";
    case RigDistribution::kPaperReal:
      return "paper-real";
    case RigDistribution::kBroadReal:
      return "broad-real";
  }
  return "";
}

RigDistribution RigDistributionFromName(const std::string& name) {
  std::string names;
  for (const RigDistribution distribution : kDistributions) {
    if (RigDistributionName(distribution) == name) return distribution;
    names += (names.empty() ? "" : ", ") + RigDistributionName(distribution);
  }
  throw InputError({"unknown distribution of rigs '" + name + "'", "", "", "use one of " + names});
}

bool IsPapersScene(RigDistribution distribution) { return !IsBroad(distribution); }

Rig DrawRig(RigDistribution distribution, Rng& rng) {
  Rig rig = PaperRig();
  Camera& camera = rig.cameras.front();
  if (IsBroad(distribution)) {
    DrawBroadLens(&camera, rng);
    DrawBroadScene(&rig, rng);
    DrawBroadImu(&rig, rng);
  } else {
    DrawPapersLens(distribution != RigDistribution::kPaperUndistorted, &camera, rng);
  }
  rig.T_c0_i.t = Draw({0.06, 0.0, -0.1}, kTranslationStddev, rng);
  rig.T_c0_i.R = RotationFromRpy(Draw({0.0, 0.0, 1.5708}, kRotationStddev, rng));
  if (distribution == RigDistribution::kPaperReal || distribution == RigDistribution::kBroadReal) {
    SwitchOnEffects("all", &rig);
    constexpr uint64_t kNumLenses = 1'000'000'000;
    rig.lens_residual.seed = static_cast<int64_t>(rng.UniformIndex(kNumLenses));
  }
  return rig;
}

BasePose BasePoseBeforeBoard(const Rig& rig, const BasePose& base) {
  const Rigid3 nominal{RotationFromRpy(base.rpy_rad), base.xyz_m};
  const Vector3d wanted =
      DirectionOfBoard(PaperRig(), LoopPoseAt({}, LoopCoefficients::Zero(), 0.0));
  Rigid3 T_b_e = nominal;
  // The camera sits beside the frame that is turned: each pass leaves about a tenth of the error,
  // its lever over the board's distance.
  constexpr int kNumPasses = 20;
  constexpr double kSmallTurn = 1e-12;  // [rad]
  bool is_turned = false;
  for (int i = 0; i < kNumPasses; ++i) {
    const Vector3d seen = DirectionOfBoard(rig, T_b_e);
    const double angle = std::atan2(seen.cross(wanted).norm(), seen.dot(wanted));
    if (angle < kSmallTurn) break;
    is_turned = true;
    // The camera turns the other way than what it sees.
    const Eigen::Matrix3d R_c0 =
        Eigen::Quaterniond::FromTwoVectors(wanted, seen).toRotationMatrix();
    T_b_e.R = T_b_e.R * rig.T_e_c0.R * R_c0 * rig.T_e_c0.R.transpose();
  }
  if (!is_turned) return base;
  return {base.xyz_m, RpyFromRotation(T_b_e.R)};
}

Eigen::Vector4d PriorMeanIntrinsics() {
  return PaperRig().cameras.front().model.focal_and_centre();
}

}  // namespace calibrato
