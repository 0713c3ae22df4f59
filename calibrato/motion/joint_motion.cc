#include "calibrato/motion/joint_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace calibrato {
namespace {

using Eigen::Vector3d;

constexpr double kSpacing = WayPointPhase(1);

}  // namespace

CarrierState CarrierStateOf(const JointMotion& joints) {
  const PandaAxes axes = AxesOf(joints.position);
  Vector3d omega = Vector3d::Zero();
  Vector3d alpha = Vector3d::Zero();
  Vector3d velocity = Vector3d::Zero();
  Vector3d acceleration = Vector3d::Zero();
  Vector3d origin = axes.T_b_link[0].t;
  const auto step_to = [&](const Vector3d& next) {
    const Vector3d step = next - origin;
    velocity += omega.cross(step);
    acceleration += alpha.cross(step) + omega.cross(omega.cross(step));
    origin = next;
  };
  for (size_t k = 0; k < axes.T_b_link.size(); ++k) {
    const auto joint = static_cast<Eigen::Index>(k);
    step_to(axes.T_b_link[k].t);
    const Vector3d axis = axes.T_b_link[k].R.col(2);
    alpha += axis * joints.acceleration[joint] + omega.cross(axis) * joints.velocity[joint];
    omega += axis * joints.velocity[joint];
  }
  step_to(axes.T_b_e.t);
  return {.T_b_e = axes.T_b_e,
          .velocity_b = velocity,
          .acceleration_b = acceleration,
          .angular_velocity_b = omega,
          .angular_acceleration_b = alpha};
}

LoopJointSpline::LoopJointSpline(const JointPath& path, size_t loop) {
  for (int i = 1; i <= kNumWayPoints; ++i) joints_.row(i - 1) = path.At(loop, i).transpose();
  // The second derivatives at the knots: M_i-1 + 4 M_i + M_i+1 = 6 / h^2 (q_i-1 - 2 q_i + q_i+1).
  using Matrix = Eigen::Matrix<double, kNumWayPoints, kNumWayPoints>;
  static const Matrix inverse = [] {
    Matrix system = Matrix::Zero();
    for (int i = 0; i < kNumWayPoints; ++i) {
      system(i, i) = 4.0;
      system(i, (i + 1) % kNumWayPoints) = 1.0;
      system((i + 1) % kNumWayPoints, i) = 1.0;
    }
    return Matrix(system.llt().solve(Matrix::Identity()));
  }();
  LoopJoints right;
  for (int i = 0; i < kNumWayPoints; ++i) {
    right.row(i) = joints_.row((i + kNumWayPoints - 1) % kNumWayPoints) - 2.0 * joints_.row(i) +
                   joints_.row((i + 1) % kNumWayPoints);
  }
  second_ = inverse * (6.0 / (kSpacing * kSpacing) * right);
}

JointMotion LoopJointSpline::At(const Phase& phase) const {
  const double position = phase.theta / kSpacing;
  const int segment = std::clamp(static_cast<int>(position), 0, kNumWayPoints - 1);
  const int from = (segment + kNumWayPoints - 1) % kNumWayPoints;
  const int to = segment;  // row i - 1 is way-point i, and segment i ends at way-point i + 1
  const double u = position - segment;
  const double w = 1.0 - u;
  constexpr double kSixth = kSpacing * kSpacing / 6.0;
  const JointVector q =
      (w * joints_.row(from) + u * joints_.row(to) +
       kSixth * ((w * w * w - w) * second_.row(from) + (u * u * u - u) * second_.row(to)))
          .transpose();
  const JointVector first =
      ((joints_.row(to) - joints_.row(from)) / kSpacing +
       kSpacing / 6.0 *
           ((3.0 * u * u - 1.0) * second_.row(to) - (3.0 * w * w - 1.0) * second_.row(from)))
          .transpose();
  const JointVector second = (w * second_.row(from) + u * second_.row(to)).transpose();
  const JointVector third = (second_.row(to) - second_.row(from)).transpose() / kSpacing;
  const double rate = phase.first;
  return {.position = q,
          .velocity = first * rate,
          .acceleration = second * (rate * rate) + first * phase.second,
          .jerk = third * (rate * rate * rate) + second * (3.0 * rate * phase.second) +
                  first * phase.third};
}

JointRange LoopJointSpline::RangeOnTheWayTo(int way_point) const {
  assert(way_point >= 1 && way_point <= kNumWayPoints);
  const int to = way_point - 1;
  const int from = (to + kNumWayPoints - 1) % kNumWayPoints;
  JointRange range;
  for (int i = 0; i < 7; ++i) {
    const double p0 = joints_(from, i);
    const double p1 = joints_(to, i);
    const double m0 = kSpacing * kSpacing * second_(from, i);
    const double m1 = kSpacing * kSpacing * second_(to, i);
    // p0 + slope u + m0 u^2 / 2 + (m1 - m0) u^3 / 6 for u in [0, 1].
    const double slope = p1 - p0 - (2.0 * m0 + m1) / 6.0;
    range.lower[i] = std::min(p0, p1);
    range.upper[i] = std::max(p0, p1);
    const auto include = [&](double u) {
      if (!(u > 0.0 && u < 1.0)) return;
      const double p = p0 + u * (slope + u * (0.5 * m0 + u * (m1 - m0) / 6.0));
      range.lower[i] = std::min(range.lower[i], p);
      range.upper[i] = std::max(range.upper[i], p);
    };
    // Where slope + m0 u + (m1 - m0) u^2 / 2 vanishes, in the form that does not cancel.
    const double discriminant = m0 * m0 - 2.0 * (m1 - m0) * slope;
    if (!(discriminant >= 0.0)) continue;
    const double q = -(m0 + std::copysign(std::sqrt(discriminant), m0));
    include(q / (m1 - m0));
    include(2.0 * slope / q);
  }
  return range;
}

JointTrajectory::JointTrajectory(const TimedMotion& motion) {
  const size_t num_loops = motion.loop_duration_s.size();
  assert(!motion.joint_path.empty() && motion.joint_path.size() == kNumWayPoints * num_loops);
  JointPath path;
  path.start = motion.joint_path.back().position;
  auto sample = motion.joint_path.begin();
  for (size_t loop = 0; loop < num_loops; ++loop) {
    for (JointVector& q : path.loops.emplace_back()) q = (sample++)->position;
    ++sample;  // the closing way-point is the start
    laws_.push_back(motion.LawOf(loop));
  }
  for (size_t loop = 0; loop < num_loops; ++loop) loops_.emplace_back(path, loop);
}

JointMotion JointTrajectory::At(double t_s) const {
  size_t loop = 0;
  while (loop + 1 < loops_.size() && t_s > laws_[loop].duration_s) t_s -= laws_[loop++].duration_s;
  return loops_[loop].At(PhaseAt(laws_[loop], t_s));
}

}  // namespace calibrato
