#include "calibrato/mdp/path_free_design.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "calibrato/calibration/planned_frame.h"
#include "calibrato/geometry/rpy.h"
#include "calibrato/motion/carrier.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

constexpr double kMarginPx = 8.0;
constexpr double kLeastWeight = 1e-4;

Vector3d Uniform(const Vector3d& half_width, Rng& rng) {
  Vector3d v;
  for (int k = 0; k < 3; ++k) v(k) = rng.Uniform(-half_width(k), half_width(k));
  return v;
}

// From where the board fills the image to where it is small, turned any way: positions anywhere
// within reach, the camera's axis on some place of the board's surroundings, rolled by any angle,
// and tilted by up to 0.6 rad about all axes.
Rigid3 RandomControlledPose(const Rig& rig, const FreeCarrierLimits& limits, Rng& rng) {
  Rigid3 T_b_e;
  do {
    T_b_e.t = FreeCarrierShoulder() + Uniform(Vector3d::Constant(limits.reach), rng);
  } while ((T_b_e.t - FreeCarrierShoulder()).norm() > limits.reach ||
           T_b_e.t.z() < limits.min_height);
  const Rigid3 T_b_g = ArmBaseInWorld().Inverse() * rig.T_w_g;
  const Vector3d target = T_b_g * (BoardCentre(rig.board) + Uniform({0.3, 0.3, 0.0}, rng));
  const Vector3d z = (target - T_b_e.t).normalized();
  const Vector3d x = z.unitOrthogonal();
  Eigen::Matrix3d looking;
  looking << x, z.cross(x), z;
  const double roll = rng.Uniform(-M_PI, M_PI);
  const Vector3d tilt = Uniform({0.6, 0.6, 0.0}, rng);
  const Eigen::Matrix3d R_b_c = looking * RotationFromRpy({0.0, 0.0, roll}) * RotationFromRpy(tilt);
  T_b_e.R = R_b_c * rig.T_e_c0.R.transpose();
  return T_b_e;
}

}  // namespace

PathFreeDesign DesignFrames(const Rig& rig, int num_candidates, double num_frames, Rng& rng) {
  assert(num_candidates >= 3 && num_frames > 0.0 && !rig.cameras.empty());
  const Camera& camera = rig.cameras.front();
  const BoardView points = PlannedView(rig.board);
  const Rigid3 T_c_e = rig.T_e_c0.Inverse();
  const Rigid3 T_b_g = ArmBaseInWorld().Inverse() * rig.T_w_g;
  const double variance = rig.corner_noise.stddev_px * rig.corner_noise.stddev_px;
  std::vector<Rigid3> poses;
  std::vector<Eigen::MatrixXd> information;
  while (static_cast<int>(poses.size()) < num_candidates) {
    const Rigid3 T_b_e = RandomControlledPose(rig, {}, rng);
    const Rigid3 T_c_g = T_c_e * T_b_e.Inverse() * T_b_g;
    if (MarginInImage(camera.model, camera.resolution, points, T_c_g) < kMarginPx) continue;
    const auto frame = CameraInformationOfFrame(camera.model, points, T_c_g);
    if (!frame) continue;
    poses.push_back(T_c_g);
    information.push_back(*frame * (num_frames / variance));
  }
  const int focal = CameraModel::FocalIndex(camera.model.name());
  const WeightDesign design = OptimalWeights(information, {focal, focal + 1, focal + 2, focal + 3},
                                             Eigen::Vector4d::Ones());
  std::vector<size_t> order(poses.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return design.weights[a] > design.weights[b]; });
  PathFreeDesign result;
  result.a_optimality = design.value;
  result.lower_bound = design.lower_bound;
  for (const size_t k : order) {
    if (design.weights[k] < kLeastWeight) break;
    result.T_c_g.push_back(poses[k]);
    result.weights.push_back(design.weights[k]);
  }
  return result;
}

}  // namespace calibrato
