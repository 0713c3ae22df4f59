#include "calibrato/motion/joint_timing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibrato/motion/joint_motion.h"
#include "calibrato/motion/panda_dynamics.h"
#include "calibrato/motion/stretch.h"

namespace calibrato {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

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

double LargestRatio(const JointVector& values, const JointVector& bounds) {
  return values.cwiseAbs().cwiseQuotient(bounds).maxCoeff();
}

// More than 1 where the joints must be slower; else the largest share of a torque's limit.
double StretchByTorque(const JointMotion& joints, const JointVector& limits) {
  const JointVector still = JointVector::Zero();
  const JointVector holding = PandaTorque(joints.position, still, still);
  const JointVector friction = kViscousFriction * joints.velocity;
  const JointVector torque = PandaTorque(joints.position, joints.velocity, joints.acceleration);
  const JointVector inertial = torque - holding - friction;
  double fastest = 1.0;
  for (int i = 0; i < limits.size(); ++i) {
    fastest = std::min(fastest, FastestWithin(holding[i], friction[i], inertial[i], limits[i]));
  }
  return fastest < 1.0 ? 1.0 / fastest : LargestRatio(torque, limits);
}

// Stretched by c, velocities fall as 1 / c, accelerations as 1 / c^2, jerks as 1 / c^3.
double StretchByMotion(const JointMotion& joints, const PandaLimits& limits) {
  return std::max({LargestRatio(joints.velocity, limits.velocity),
                   std::sqrt(LargestRatio(joints.acceleration, limits.acceleration)),
                   std::cbrt(LargestRatio(joints.jerk, limits.jerk))});
}

}  // namespace

double SmallestStretch(const JointPath& path, size_t loop, const TimeLaw& law,
                       const PandaLimits& limits) {
  const LoopJointSpline spline(path, loop);
  const auto joints_at = [&](double t_s) { return spline.At(PhaseAt(law, t_s)); };
  // The path's pieces meet at its way-points.
  std::vector<double> passing_s;
  for (int i = 1; i < kNumWayPoints; ++i) {
    passing_s.push_back(TimeOfPhase(law, WayPointPhase(i)));
  }
  const double by_motion = LargestDuring(
      law, passing_s, 1.0, [&](double t_s) { return StretchByMotion(joints_at(t_s), limits); });
  if (!limits.torque.array().isFinite().any()) return by_motion;
  return LargestDuring(law, {}, by_motion,
                       [&](double t_s) { return StretchByTorque(joints_at(t_s), limits.torque); });
}

PhaseLimits PhaseLimitsOfJoints(const LoopJointSpline& spline, double theta,
                                const PandaLimits& limits) {
  const JointMotion by_phase =
      spline.At({.theta = theta, .first = 1.0, .second = 0.0, .third = 0.0});
  const JointVector& q = by_phase.position;
  const JointVector& first = by_phase.velocity;
  const JointVector& second = by_phase.acceleration;
  const JointVector still = JointVector::Zero();
  const JointVector holding = PandaTorque(q, still, still);
  const JointVector friction = kViscousFriction * first;
  const JointVector inertia = PandaTorque(q, still, first) - holding;
  const JointVector inertial = PandaTorque(q, first, second) - holding - friction;
  PhaseLimits at_phase;
  const double max_speed =
      std::min(1.0 / LargestRatio(first, limits.velocity), kTurn / kShortestLoop);
  at_phase.max_squared_speed = max_speed * max_speed;
  for (int i = 0; i < q.size(); ++i) {
    for (const double side : {1.0, -1.0}) {
      if (!std::isfinite(limits.acceleration[i])) continue;
      at_phase.rows.push_back({side * first[i], side * second[i], limits.acceleration[i]});
      if (!std::isfinite(limits.torque[i])) continue;
      const double f = side * friction[i];
      // sqrt(x) <= (x + v^2) / (2 v) and sqrt(x) >= x / v for x in [0, v^2].
      const double slope = f > 0.0 ? 0.5 * f / max_speed : f / max_speed;
      const double offset = f > 0.0 ? 0.5 * f * max_speed : 0.0;
      at_phase.rows.push_back({side * inertia[i], side * inertial[i] + slope,
                               limits.torque[i] - side * holding[i] - offset});
    }
  }
  return at_phase;
}

std::vector<JointSample> TimedJointPath(const JointPath& path, const std::vector<TimeLaw>& laws) {
  std::vector<JointSample> samples;
  double begin_s = 0.0;
  for (size_t loop = 0; loop < path.loops.size(); ++loop) {
    for (int i = 1; i < kNumWayPoints; ++i) {
      const double t_s = TimeOfPhase(laws[loop], WayPointPhase(i));
      samples.push_back({begin_s + t_s, path.At(loop, i)});
    }
    begin_s += laws[loop].duration_s;
    samples.push_back({begin_s, path.start});
  }
  return samples;
}

}  // namespace calibrato
