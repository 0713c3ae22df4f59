#pragma once

#include <vector>

#include "calibrato/motion/carrier.h"
#include "calibrato/motion/looped_path.h"
#include "calibrato/motion/time_law.h"

namespace calibrato {

/// The joints of the arm at one instant.
struct JointMotion {
  JointVector position;      ///< [rad]
  JointVector velocity;      ///< [rad/s]
  JointVector acceleration;  ///< [rad/s^2]
  JointVector jerk;          ///< [rad/s^3]
};

/// How the controlled frame moves when the joints move so: exact, by the recursion over the links.
[[nodiscard]] CarrierState CarrierStateOf(const JointMotion& joints);

/// The joints between the way-points of one loop: the periodic cubic spline by the phase. (Its
/// error against a way through the poses themselves is below 0.1 mm for loops of harmonics up to
/// 4.) Jerk is piecewise constant by the phase.
class LoopJointSpline {
 public:
  LoopJointSpline(const JointPath& path, size_t loop);
  [[nodiscard]] JointMotion At(const Phase& phase) const;
  /// The lowest and the highest angle of each joint on the way to way-point 1 .. 62 from the one
  /// before it, both included: a spline swings beyond its way-points.
  [[nodiscard]] JointRange RangeOnTheWayTo(int way_point) const;

 private:
  // One row a way-point, 1 to 62.
  using LoopJoints = Eigen::Matrix<double, kNumWayPoints, 7>;
  LoopJoints joints_;
  LoopJoints second_;  // derivatives by the phase at the way-points
};

/// The joints during a whole motion on the arm; at rest before and after it.
class JointTrajectory {
 public:
  /// @pre motion.joint_path is there, that is, the motion was planned on the arm.
  explicit JointTrajectory(const TimedMotion& motion);
  [[nodiscard]] JointMotion At(double t_s) const;

 private:
  std::vector<LoopJointSpline> loops_;
  std::vector<TimeLaw> laws_;
};

}  // namespace calibrato
