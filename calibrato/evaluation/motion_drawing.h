#pragma once

#include <Eigen/Core>
#include <functional>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/contestant.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// A motion as pages draw and play it (docs/formats.md section 4), all lengths in [m] in the base
/// frame b:
///
///     path_length_m, motion_s
///     loops       the camera's way, loop by loop: [x y z] each
///     axis_b      where the camera looks now and then: a point and a direction, six numbers each
///     played      {step_s; camera_b: [x y z qx qy qz qw] a step, of cam0;
///                  arm_b: the points of the arm's links from foot to flange, a row [x y z x y z
///                  ..] a step; empty without an arm}
///
/// @param arm_points  Of an arm that is not the Panda: the points of its links, base first, a
/// column each, by its joint angles.
[[nodiscard]] Value MotionDrawing(
    const ExecutableMotion& motion, const Rig& rig,
    const std::function<Eigen::Matrix3Xd(const Eigen::Matrix<double, 7, 1>& q)>& arm_points = {});

/// The corners of the board's outer points in the base frame b: four times [x y z] [m].
[[nodiscard]] Value BoardOutline(const Rig& rig);

}  // namespace calibrato
