#include "calibrato/motion/board_in_view.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace calibrato {
namespace {

double AngleOffAxis(const Eigen::Vector3d& p_c) {
  return std::atan2(p_c.head<2>().norm(), p_c.z());
}

double LargestAngleInImage(const Camera& camera) {
  double largest = 0.0;
  for (const double u : {-0.5, camera.resolution.width - 0.5}) {
    for (const double v : {-0.5, camera.resolution.height - 0.5}) {
      const std::optional<Eigen::Vector3d> ray = camera.model.Unproject({u, v});
      largest = std::max(largest, ray ? AngleOffAxis(*ray) : std::numbers::pi / 2.0);
    }
  }
  return largest;
}

}  // namespace

std::optional<Refusal> CheckBoardInView(const Rigid3& T_b_e, const Rig& rig) {
  assert(!rig.cameras.empty());
  const Camera& camera = rig.cameras.front();
  const Rigid3 T_w_c0 = ArmBaseInWorld() * T_b_e * rig.T_e_c0;
  const Eigen::Vector3d centre_c0 = T_w_c0.Inverse() * (rig.T_w_g * BoardCentre(rig.board));
  Refusal refusal;
  refusal.limit = "board in view";
  const std::optional<Eigen::Vector2d> pixel = camera.model.Project(centre_c0);
  if (!pixel) {
    refusal.value = AngleOffAxis(centre_c0);
    refusal.bound = LargestAngleInImage(camera);
    refusal.unit = "rad";
    return refusal;
  }
  // Pixel (0, 0) is the centre of the top-left pixel: the image begins half a pixel before it.
  const Eigen::Vector2d size(camera.resolution.width, camera.resolution.height);
  refusal.unit = "px";
  for (int axis = 0; axis < 2; ++axis) {
    refusal.value = (*pixel)[axis];
    refusal.bound = refusal.value < 0.0 ? -0.5 : size[axis] - 0.5;
    if (!(refusal.value >= -0.5 && refusal.value <= size[axis] - 0.5)) return refusal;
  }
  return std::nullopt;
}

}  // namespace calibrato
