#include "calibrato/simulation/rig_distribution.h"

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/rpy.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

constexpr double kFieldOfViewMean = 1.0;     // [rad]
constexpr double kFieldOfViewStddev = 0.05;  // [rad]
constexpr double kDistortionStddev = 0.1;    // [-]
constexpr double kTranslationStddev = 0.01;  // [m]
constexpr double kRotationStddev = 0.1;      // [rad]

Eigen::Vector3d Draw(const Eigen::Vector3d& mean, double stddev, Rng& rng) {
  Eigen::Vector3d x = mean;
  for (int i = 0; i < 3; ++i) x(i) += stddev * rng.Normal();
  return x;
}

}  // namespace

std::string RigDistributionName(RigDistribution distribution) {
  return distribution == RigDistribution::kPaper ? "paper" : "paper-undistorted";
}

RigDistribution RigDistributionFromName(const std::string& name) {
  for (const RigDistribution distribution :
       {RigDistribution::kPaper, RigDistribution::kPaperUndistorted}) {
    if (RigDistributionName(distribution) == name) return distribution;
  }
  throw InputError(
      {"unknown distribution of rigs '" + name + "'", "", "", "use paper or paper-undistorted"});
}

Rig DrawRig(RigDistribution distribution, Rng& rng) {
  Rig rig = PaperRig();
  Camera& camera = rig.cameras.front();
  const double f = FocalLengthFromFieldOfView(rng.Normal(kFieldOfViewMean, kFieldOfViewStddev),
                                              camera.resolution.width);
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(9);
  parameters.head<4>() << f, f, camera.model.focal_and_centre().tail<2>();
  camera.model = CameraModel("pinhole-radtan5", parameters);
  if (distribution == RigDistribution::kPaper) {
    do {
      const Eigen::Vector3d k = Draw(Eigen::Vector3d::Zero(), kDistortionStddev, rng);
      parameters(4) = k(0);
      parameters(5) = k(1);
      parameters(8) = k(2);
      camera.model = CameraModel("pinhole-radtan5", parameters);
    } while (!CoversImage(camera.model, camera.resolution));
  }
  rig.T_c0_i.t = Draw({0.06, 0.0, -0.1}, kTranslationStddev, rng);
  rig.T_c0_i.R = RotationFromRpy(Draw({0.0, 0.0, 1.5708}, kRotationStddev, rng));
  return rig;
}

Eigen::Vector4d PriorMeanIntrinsics() {
  return PaperRig().cameras.front().model.focal_and_centre();
}

}  // namespace calibrato
