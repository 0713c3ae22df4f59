#include "calibrato/motion/joint_timing.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "calibrato/motion/time_law.h"

namespace calibrato {
namespace {

// One row a way-point, 1 to 62.
using LoopJoints = Eigen::Matrix<double, kNumWayPoints, 7>;
constexpr double kSpacing = WayPointPhase(1);

LoopJoints JointsOf(const JointPath& path, size_t loop) {
  LoopJoints joints;
  for (int i = 1; i <= kNumWayPoints; ++i) joints.row(i - 1) = path.At(loop, i).transpose();
  return joints;
}

// The periodic cubic spline's second derivatives at its knots: M_i-1 + 4 M_i + M_i+1 =
// 6 / h^2 (q_i-1 - 2 q_i + q_i+1).
LoopJoints SplineSecondDerivatives(const LoopJoints& joints) {
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
    right.row(i) = joints.row((i + kNumWayPoints - 1) % kNumWayPoints) - 2.0 * joints.row(i) +
                   joints.row((i + 1) % kNumWayPoints);
  }
  return inverse * (6.0 / (kSpacing * kSpacing) * right);
}

// The times of way-points 1 to 62 as shares of the loop's duration.
std::array<double, kNumWayPoints> WayPointTimes() {
  std::array<double, kNumWayPoints> times;
  constexpr int kNumHalvings = 60;
  for (int i = 1; i < kNumWayPoints; ++i) {
    double before = 0.0;
    double after = 1.0;
    for (int k = 0; k < kNumHalvings; ++k) {
      const double middle = 0.5 * (before + after);
      (QuinticPhaseAt(middle, 1.0).theta < WayPointPhase(i) ? before : after) = middle;
    }
    times[i - 1] = after;
  }
  times.back() = 1.0;
  return times;
}

}  // namespace

double SmallestStretch(const JointPath& path, size_t loop, double duration_s) {
  constexpr int kNumInstants = 500;
  const LoopJoints joints = JointsOf(path, loop);
  const LoopJoints second = SplineSecondDerivatives(joints);
  double stretch = 1.0;
  for (int k = 0; k <= kNumInstants; ++k) {
    const Phase phase = QuinticPhaseAt(duration_s * k / kNumInstants, duration_s);
    const double position = phase.theta / kSpacing;
    const int segment = std::clamp(static_cast<int>(position), 0, kNumWayPoints - 1);
    const int from = (segment + kNumWayPoints - 1) % kNumWayPoints;
    const int to = segment;  // row i - 1 is way-point i, and segment i ends at way-point i + 1
    const double u = position - segment;
    const JointVector by_theta = (joints.row(to) - joints.row(from)).transpose() / kSpacing +
                                 kSpacing / 6.0 *
                                     ((3.0 * u * u - 1.0) * second.row(to) -
                                      (3.0 * (1.0 - u) * (1.0 - u) - 1.0) * second.row(from))
                                         .transpose();
    const JointVector by_theta_twice =
        ((1.0 - u) * second.row(from) + u * second.row(to)).transpose();
    const JointVector velocity = by_theta * phase.first;
    const JointVector acceleration =
        by_theta_twice * (phase.first * phase.first) + by_theta * phase.second;
    // Stretched by c, velocities fall as 1 / c and accelerations as 1 / c^2.
    stretch = std::max(
        {stretch, velocity.cwiseAbs().cwiseQuotient(Limits().velocity).maxCoeff(),
         std::sqrt(acceleration.cwiseAbs().cwiseQuotient(Limits().acceleration).maxCoeff())});
  }
  return stretch;
}

std::vector<JointSample> TimedJointPath(const JointPath& path,
                                        const std::vector<double>& loop_duration_s) {
  static const std::array<double, kNumWayPoints> times = WayPointTimes();
  std::vector<JointSample> samples;
  double begin_s = 0.0;
  for (size_t loop = 0; loop < path.loops.size(); ++loop) {
    for (int i = 1; i <= kNumWayPoints; ++i) {
      samples.push_back({begin_s + times[i - 1] * loop_duration_s[loop], path.At(loop, i)});
    }
    begin_s += loop_duration_s[loop];
  }
  return samples;
}

}  // namespace calibrato
