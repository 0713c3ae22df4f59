#pragma once

#include <string>
#include <vector>

#include "calibrato/motion/arm.h"

namespace calibrato {

/// ARM.yaml (docs/arms.md), and the URDF that it names, relative to itself:
///
///     name, urdf, base_link, tool_link
///     start_joints_rad, max_acceleration_rad_s2, max_jerk_rad_s3: one number a joint
///     max_velocity_rad_s: optional; else, or where the URDF has less, its own
///     capsules: [{link, a, b, radius_m}], optional: shapes beside the URDF's
///
/// Of the URDF: joints between both links, their limits, and shapes of `collision` that are boxes,
/// cylinders or spheres; each becomes the capsule around it. Meshes are not looked at. Links that
/// are fixed to the base, to a link of the arm or to the tool are parts of it, as a gripper is.
/// @throws InputError with file, line and key: unless six or seven revolute joints lie between the
/// two links, each with an axis and limits of position and velocity, and the start is within them;
/// where a shape has no size. Unknown keys, joints with no shape behind them, and links that hang
/// on the arm by joints of their own, are appended to warnings (may be null).
[[nodiscard]] Arm ReadArm(const std::string& path, std::vector<std::string>* warnings);

}  // namespace calibrato
