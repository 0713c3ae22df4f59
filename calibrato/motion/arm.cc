#include "calibrato/motion/arm.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace calibrato {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// Whole turns do not matter to a pose: each joint as near to its start as its range lets it be.
JointVector Unwound(const Arm& arm, JointVector q, const JointRange& range) {
  for (int i = 0; i < arm.num_joints(); ++i) {
    q[i] -= kTurn * std::round((q[i] - arm.start[i]) / kTurn);
    if (q[i] > range.upper[i] && q[i] - kTurn >= range.lower[i]) q[i] -= kTurn;
    if (q[i] < range.lower[i] && q[i] + kTurn <= range.upper[i]) q[i] += kTurn;
  }
  return q;
}

}  // namespace

std::vector<Rigid3> FramesOf(const Arm& arm, const JointVector& q) {
  std::vector<Rigid3> frames;
  frames.reserve(arm.joints.size() + 1);
  Rigid3 T_b_link;
  for (int i = 0; i < arm.num_joints(); ++i) {
    const Arm::Joint& joint = arm.joints[static_cast<size_t>(i)];
    T_b_link = T_b_link * joint.T_before_joint;
    T_b_link.R = T_b_link.R * Eigen::AngleAxisd(q[i], joint.axis).toRotationMatrix();
    frames.push_back(T_b_link);
  }
  frames.push_back(T_b_link * arm.T_last_e);
  return frames;
}

Rigid3 PoseOf(const Arm& arm, const JointVector& q, JointJacobian* J_pose_q) {
  const std::vector<Rigid3> frames = FramesOf(arm, q);
  if (J_pose_q != nullptr) {
    J_pose_q->setZero();
    for (int i = 0; i < arm.num_joints(); ++i) {
      const auto k = static_cast<size_t>(i);
      const Eigen::Vector3d axis = frames[k].R * arm.joints[k].axis;
      J_pose_q->col(i) << axis, axis.cross(frames.back().t - frames[k].t);
    }
  }
  return frames.back();
}

double SingularityDistance(const Arm& arm, const JointVector& q) {
  JointJacobian J;
  (void)PoseOf(arm, q, &J);
  const Eigen::Matrix<double, 6, 6> squared = J * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(squared,
                                                                          Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
}

std::optional<JointVector> InverseNear(const Arm& arm, const Rigid3& T_b_e, const JointVector& q,
                                       const JointVector& preferred) {
  constexpr int kMaxIterations = 60;
  constexpr double kTolerance = 1e-9;
  constexpr double kLongestStep = 0.5;  // of the pose error that one step takes on
  constexpr double kFar = 0.1;
  const bool is_redundant = arm.num_joints() == 7;
  JointVector solution = q;
  for (int i = 0; i < kMaxIterations; ++i) {
    JointJacobian J;
    const Rigid3 reached = PoseOf(arm, solution, &J);
    Eigen::Matrix<double, 6, 1> error = T_b_e.DifferenceTo(reached);
    if (!error.allFinite()) return std::nullopt;
    const double size = error.norm();
    double sideways = 0.0;
    JointVector null_direction = JointVector::Zero();
    if (is_redundant) {
      null_direction = PandaNullDirection(J);
      sideways = null_direction.dot(preferred - solution);
    }
    if (size < kTolerance && std::abs(sideways) < kTolerance) return solution;
    if (size > kLongestStep) error *= kLongestStep / size;
    // Damped near singularities, and well where the way is long.
    constexpr double kSquaredDamping = 1e-8;
    constexpr double kSquaredDampingFarAway = 1e-3;
    Eigen::Matrix<double, 6, 6> normal = J * J.transpose();
    normal.diagonal().array() +=
        size > kFar ? kSquaredDampingFarAway : kSquaredDamping * std::min(1.0, size);
    solution += J.transpose() * normal.llt().solve(error) + sideways * null_direction;
  }
  return std::nullopt;
}

std::vector<JointVector> PosturesAt(const Arm& arm, const Rigid3& T_b_e, const JointRange& range) {
  constexpr int kPointsAJoint = 3;
  constexpr double kOther = 0.5;  // [rad]
  std::vector<JointVector> postures;
  const auto take = [&](const JointVector& seed) {
    const std::optional<JointVector> q = InverseNear(arm, T_b_e, seed, arm.start);
    if (!q) return;
    const JointVector unwound = Unwound(arm, *q, range);
    if (JointLimitExcess(unwound, range) > 0.0) return;
    const bool is_other = std::ranges::all_of(postures, [&](const JointVector& known) {
      return (unwound - known).cwiseAbs().maxCoeff() > kOther;
    });
    if (is_other) postures.push_back(unwound);
  };
  take(arm.start);
  // The first joint turns the arm as a whole: its start serves all lattice points.
  int num_points = 1;
  for (int i = 1; i < std::min(arm.num_joints(), 6); ++i) num_points *= kPointsAJoint;
  for (int point = 0; point < num_points; ++point) {
    JointVector seed = arm.start;
    int rest = point;
    for (int i = 1; i < std::min(arm.num_joints(), 6); ++i) {
      const double low = std::max(range.lower[i], arm.start[i] - std::numbers::pi);
      const double high = std::min(range.upper[i], arm.start[i] + std::numbers::pi);
      seed[i] = low + (high - low) * (rest % kPointsAJoint + 0.5) / kPointsAJoint;
      rest /= kPointsAJoint;
    }
    take(seed);
  }
  std::ranges::stable_sort(postures, [&](const JointVector& a, const JointVector& b) {
    return (a - arm.start).norm() < (b - arm.start).norm();
  });
  return postures;
}

}  // namespace calibrato
