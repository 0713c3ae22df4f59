#include "calibrato/simulation/swaying_board.h"

#include <cmath>
#include <numbers>

namespace calibrato {
namespace {

// No two of them, and none with a loop's 5 s, return together soon.
const Eigen::Vector3d kPeriods(11.0, 17.0, 23.0);  // [s]

}  // namespace

Rigid3 BoardInWorld(const Rig& rig, double t_s) {
  if (rig.stand_motion_m == 0.0) return rig.T_w_g;
  // The mean square of a sine is a half, and there are three.
  const Eigen::Array3d phases = 2.0 * std::numbers::pi * t_s / kPeriods.array();
  const Eigen::Vector3d way_g = std::sqrt(2.0 / 3.0) * rig.stand_motion_m * phases.sin();
  return {rig.T_w_g.R, rig.T_w_g * way_g};
}

Rigid3 BoardInCamera(const Rig& rig, const CarrierPath& path, double t_s) {
  return (ArmBaseInWorld() * path.at(t_s).T_b_e * rig.T_e_c0).Inverse() * BoardInWorld(rig, t_s);
}

}  // namespace calibrato
