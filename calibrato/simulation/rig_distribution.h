#pragma once

#include <Eigen/Core>
#include <string>

#include "calibrato/base/rng.h"
#include "calibrato/motion/looped_trajectory.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// Where simulated rigs are drawn from.
enum class RigDistribution {
  /// The paper's Table 4: field of view N(1.0, 0.05) rad, T_cam_imu around (0.06, 0, -0.1) m and
  /// (0, 0, 1.5708) rad with
  /// 0.01 m and 0.1 rad; and k1 k2 k3 ~ N(0, 0.1), redrawn until every pixel of the image has a
  /// ray.
  kPaper,
  /// The same with a lens that does not distort.
  kPaperUndistorted,
  /// Rigs of all kinds (U: uniform in +-):
  ///   lens        of 3 in 4 rigs pinhole-radtan5, field of view 0.7 to 1.6 rad, k1 k2 k3 ~
  ///               N(0, 0.1), p1 p2 ~ N(0, 5e-4); else a fisheye, pinhole-equi, 1.6 to 2.4 rad, k1
  ///               .. k4 ~ N(0, 0.01); fv / fu ~ N(1, 1e-3), principal point N(0, 5 px) beside the
  ///               paper's; redrawn until it covers the image
  ///   board       the paper's, or an AprilGrid of 6 x 6 tags of 88 mm, 26.4 mm apart; its middle
  ///               U(0.05 m) in each axis from where the paper's is, turned by U(10 degrees) about
  ///               each
  ///   mount       T_e_c0: U(0.02 m) in each axis, U(5 degrees) about each
  ///   T_cam_imu   as kPaper
  ///   IMU         a grade between the paper's and ten times as noisy (log-uniform), each of its
  ///               four figures half to twice that of its grade; biases N(0, 0.01 rad/s), N(0, 0.1
  ///               m/s^2)
  ///   time offset U(20 ms)
  /// A motion for such a rig is planned relative to its board: BasePoseBeforeBoard.
  kBroad,
  /// kPaper and kBroad with all effects of real arms, cameras and IMUs at their ordinary sizes
  /// (sensors/effects.h), each rig with a residual of its lens of its own.
  kPaperReal,
  kBroadReal,
};
/// "paper", "paper-undistorted", "broad", "paper-real", "broad-real"
[[nodiscard]] std::string RigDistributionName(RigDistribution distribution);
[[nodiscard]] RigDistribution RigDistributionFromName(
    const std::string& name);  ///< @throws InputError
/// Whether board and mount are where PaperRig has them, so that one plan serves all rigs.
[[nodiscard]] bool IsPapersScene(RigDistribution distribution);

/// A rig in the paper's scene, or beside it.
[[nodiscard]] Rig DrawRig(RigDistribution distribution, Rng& rng);

/// What one look at the board is for: the base pose of a motion before this rig's board. The
/// controlled frame is where `base` has it, turned by the smallest angle that brings the middle of
/// the board into the direction in which the camera of PaperRig sees its own. Callers who draw rigs
/// set Motion::base_pose to it before they plan; offsets of the loops then add to a view that has
/// the board in its middle.
/// @return `base` itself where nothing is to be turned, as for all rigs of the paper's scene.
/// @throws InputError if the board is where no turn shows it: within 1 cm of the camera.
[[nodiscard]] BasePose BasePoseBeforeBoard(const Rig& rig, const BasePose& base = {});

/// What is believed of fu fv pu pv before any data: the camera at the mean of Table 4 [px].
[[nodiscard]] Eigen::Vector4d PriorMeanIntrinsics();

}  // namespace calibrato
