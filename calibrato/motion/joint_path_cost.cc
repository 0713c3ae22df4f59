#include "calibrato/motion/joint_path_cost.h"

#include <algorithm>

namespace calibrato {
namespace {

// How far each joint has gone into its wall at either end; the two never meet.
JointVector IntoLowerWall(const JointVector& q, const JointRange& range, double margin) {
  return ((range.lower - q).array() + margin).max(0.0);
}
JointVector IntoUpperWall(const JointVector& q, const JointRange& range, double margin) {
  return ((q - range.upper).array() + margin).max(0.0);
}

}  // namespace

const JointVector& JointPathCost::StepWeights() {
  static const JointVector weights = (3.75 / Limits().acceleration.array()).square();
  return weights;
}

double JointPathCost::Step(const JointVector& step) {
  return 0.5 * StepWeights().dot(step.cwiseAbs2());
}

double JointPathCost::Wall(const JointVector& q) const {
  double cost = 0.5 * weight *
                (IntoLowerWall(q, range, margin).squaredNorm() +
                 IntoUpperWall(q, range, margin).squaredNorm());
  for (const KeptDistance& kept : kept_distances) {
    const double missing = std::max(0.0, kept.margin - kept.distance(q));
    cost += 0.5 * kept.weight * missing * missing;
  }
  return cost;
}

JointPathCost::Derivatives JointPathCost::WallAlong(const JointVector& q,
                                                    const JointVector& direction) const {
  const JointVector upper = IntoUpperWall(q, range, margin);
  const JointVector lower = IntoLowerWall(q, range, margin);
  const JointVector curvature = weight * ((upper + lower).array() > 0.0).cast<double>();
  Derivatives along{weight * direction.dot(upper - lower), direction.cwiseAbs2().dot(curvature)};
  for (const KeptDistance& kept : kept_distances) {
    const double missing = kept.margin - kept.distance(q);
    if (!(missing > 0.0)) continue;
    constexpr double kStep = 1e-4;  // [rad]
    const double slope =
        (kept.distance(q + kStep * direction) - kept.distance(q - kStep * direction)) /
        (2.0 * kStep);
    along.first -= kept.weight * missing * slope;
    along.second += kept.weight * slope * slope;
  }
  return along;
}

}  // namespace calibrato
