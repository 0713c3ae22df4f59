#include "calibrato/motion/joint_path_cost.h"

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
  return 0.5 * weight *
         (IntoLowerWall(q, range, margin).squaredNorm() +
          IntoUpperWall(q, range, margin).squaredNorm());
}

JointVector JointPathCost::WallGradient(const JointVector& q) const {
  return weight * (IntoUpperWall(q, range, margin) - IntoLowerWall(q, range, margin));
}

JointVector JointPathCost::WallCurvature(const JointVector& q) const {
  const JointVector into = IntoUpperWall(q, range, margin) + IntoLowerWall(q, range, margin);
  return weight * (into.array() > 0.0).cast<double>();
}

}  // namespace calibrato
