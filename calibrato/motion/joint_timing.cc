#include "calibrato/motion/joint_timing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrato/motion/joint_motion.h"
#include "calibrato/motion/panda_dynamics.h"
#include "calibrato/motion/time_law.h"

namespace calibrato {
namespace {

// The largest speed x <= 1 such that holding + friction x + inertial x^2 stays within +-limit at
// all speeds up to x. Slower by x, friction falls as x and what accelerations take as x^2.
double FastestWithin(double holding, double friction, double inertial, double limit) {
  if (!(std::abs(holding) < limit)) return 0.0;
  double fastest = 1.0;
  for (const double bound : {-limit, limit}) {
    // a x^2 + b x + c = 0, by the formula that does not cancel.
    const double a = inertial;
    const double b = friction;
    const double c = holding - bound;
    const double discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0) continue;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    for (const double root : {q / a, c / q}) {
      if (root > 0.0) fastest = std::min(fastest, root);
    }
  }
  return fastest;
}

double StretchByTorque(const JointMotion& joints, const JointVector& limits) {
  const JointVector still = JointVector::Zero();
  const JointVector holding = PandaTorque(joints.position, still, still);
  const JointVector friction = kViscousFriction * joints.velocity;
  const JointVector inertial =
      PandaTorque(joints.position, joints.velocity, joints.acceleration) - holding - friction;
  double fastest = 1.0;
  for (int i = 0; i < limits.size(); ++i) {
    fastest = std::min(fastest, FastestWithin(holding[i], friction[i], inertial[i], limits[i]));
  }
  return 1.0 / fastest;
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

double SmallestStretch(const JointPath& path, size_t loop, double duration_s,
                       const PandaLimits& limits) {
  constexpr int kNumInstants = 500;
  const LoopJointSpline spline(path, loop);
  const auto largest_ratio = [](const JointVector& values, const JointVector& bounds) {
    return values.cwiseAbs().cwiseQuotient(bounds).maxCoeff();
  };
  double stretch = 1.0;
  for (int k = 0; k <= kNumInstants; ++k) {
    const JointMotion joints = spline.At(QuinticPhaseAt(duration_s * k / kNumInstants, duration_s));
    // Stretched by c, velocities fall as 1 / c, accelerations as 1 / c^2, jerks as 1 / c^3.
    stretch = std::max({stretch, largest_ratio(joints.velocity, limits.velocity),
                        std::sqrt(largest_ratio(joints.acceleration, limits.acceleration)),
                        std::cbrt(largest_ratio(joints.jerk, limits.jerk)),
                        StretchByTorque(joints, limits.torque)});
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
