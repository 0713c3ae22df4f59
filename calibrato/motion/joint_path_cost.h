#pragma once

#include "calibrato/motion/panda.h"

namespace calibrato {

/// What a joint path costs. Steps between way-points: half the sum of squared joint steps, each
/// joint weighted by the inverse square of its acceleration limit (1 at 3.75 rad/s^2), since
/// accelerations are what stretches time. Way-points: a soft wall before each joint limit, weight /
/// 2 * (margin - distance)^2 where a joint is nearer to a limit than the margin, or beyond it.
struct JointPathCost {
  double margin = 0.1;    ///< [rad]
  double weight = 100.0;  ///< [1/rad^2]
  JointRange range = {};  ///< Whose ends are the limits.

  [[nodiscard]] static const JointVector& StepWeights();
  [[nodiscard]] static double Step(const JointVector& step);
  [[nodiscard]] double Wall(const JointVector& q) const;
  [[nodiscard]] JointVector WallGradient(const JointVector& q) const;
  /// The diagonal of the wall's second derivative.
  [[nodiscard]] JointVector WallCurvature(const JointVector& q) const;
};

}  // namespace calibrato
