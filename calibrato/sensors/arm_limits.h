#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/geometry/rigid3.h"

namespace calibrato {

/// A box that the arm must not enter.
struct KeepOutBox {
  std::string name;
  Rigid3 T_b_box;          ///< In the arm's base frame; the origin is the middle of the box.
  Eigen::Vector3d size_m;  ///< Whole lengths along the box's axes > 0 [m].
};

/// What an arm's owner forbids beyond what the arm can't do.
struct ArmLimits {
  /// Each joint stays within these and the arm's own [rad].
  Eigen::Matrix<double, 7, 1> joint_lower =
      Eigen::Matrix<double, 7, 1>::Constant(-std::numeric_limits<double>::infinity());
  Eigen::Matrix<double, 7, 1> joint_upper =
      Eigen::Matrix<double, 7, 1>::Constant(std::numeric_limits<double>::infinity());
  /// The last joint turns no further than this from where it starts, so that cables on the hand are
  /// not wound up [rad]. Loops return to their start: turns do not add up over them.
  double max_wrist_turn = std::numeric_limits<double>::infinity();
  double clearance_m = 0.01;  ///< Between the arm, itself and everything around it >= 0 [m].
  std::vector<KeepOutBox> keep_out;
};

/// RIG.yaml's optional key `arm.limits`: {joint_lower_rad: [7], joint_upper_rad: [7],
/// max_wrist_turn_rad, clearance_m, keep_out: [{name, T_b_box, size_m: [3]}]}, each optional.
/// @throws InputError with line and key. Unknown keys are appended to warnings (may be null).
[[nodiscard]] ArmLimits ArmLimitsFromValue(const Value& value, std::vector<std::string>* warnings);
/// What is not limited is left out.
[[nodiscard]] Value ToValue(const ArmLimits& limits);

}  // namespace calibrato
