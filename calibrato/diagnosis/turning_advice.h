#pragma once

#include <Eigen/Core>
#include <string>

namespace calibrato {

/// What to do so that an extrinsic rotation about an axis of the camera, or a translation along it,
/// shows better: "turn the camera to and fro about its y (look left and right) faster; so far 0.21
/// rad/s on average". A lever arm along an axis, and a rotation about it, show when the rig turns
/// about another axis: the slower of the two others is the one to work on.
/// @param axis     0, 1, 2: x, y, z of the camera.
/// @param turning  How fast the rig turned about each of them so far, root mean square [rad/s].
[[nodiscard]] std::string AdviceOnTurning(int axis, const Eigen::Vector3d& turning);

/// The axis that it speaks of: "x", "y" or "z".
[[nodiscard]] std::string AxisToTurnAbout(int axis, const Eigen::Vector3d& turning);

}  // namespace calibrato
