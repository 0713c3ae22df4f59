#pragma once

#include <functional>
#include <vector>

#include "calibrato/motion/panda.h"

namespace calibrato {

/// A distance that a path should keep: from obstacles, from singularities.
struct KeptDistance {
  std::function<double(const JointVector& q)> distance;
  double margin;  ///< Nearer costs weight / 2 * (margin - distance)^2.
  double weight;
};

/// What a joint path costs. Steps between way-points: half the sum of squared joint steps, each
/// joint weighted by the inverse square of its acceleration limit (1 at 3.75 rad/s^2), since
/// accelerations are what stretches time. Way-points: a soft wall before each joint limit, weight /
/// 2 * (margin - distance)^2 where a joint is nearer to a limit than the margin, or beyond it; and
/// the same for each distance that is to be kept.
struct JointPathCost {
  double margin = 0.1;    ///< [rad]
  double weight = 100.0;  ///< [1/rad^2]
  JointRange range = {};  ///< Whose ends are the limits.
  std::vector<KeptDistance> kept_distances = {};

  [[nodiscard]] static const JointVector& StepWeights();
  [[nodiscard]] static double Step(const JointVector& step);
  /// All that the way-point itself costs.
  [[nodiscard]] double Wall(const JointVector& q) const;
  /// Its slope and Gauss-Newton's curvature for steps along a direction.
  struct Derivatives {
    double first;
    double second;
  };
  [[nodiscard]] Derivatives WallAlong(const JointVector& q, const JointVector& direction) const;
};

}  // namespace calibrato
