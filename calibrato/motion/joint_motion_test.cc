#include "calibrato/motion/joint_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/motion/way_point.h"

namespace calibrato {
namespace {

// A joint path in closed form: each joint swings about the middle of its limits.
JointMotion SwingAt(double t_s) {
  JointMotion joints;
  for (int i = 0; i < 7; ++i) {
    const double rate = 0.7 + 0.3 * i;
    const double middle = 0.5 * (Limits().lower[i] + Limits().upper[i]);
    joints.position[i] = middle + 0.5 * std::sin(rate * t_s + i);
    joints.velocity[i] = 0.5 * rate * std::cos(rate * t_s + i);
    joints.acceleration[i] = -0.5 * rate * rate * std::sin(rate * t_s + i);
    joints.jerk[i] = -0.5 * rate * rate * rate * std::cos(rate * t_s + i);
  }
  return joints;
}

TEST(CarrierStateOf, DerivativesAgreeWithDifferences) {
  constexpr double kStep = 1e-5;
  for (const double t_s : {0.0, 0.4, 1.7}) {
    const CarrierState before = CarrierStateOf(SwingAt(t_s - kStep));
    const CarrierState state = CarrierStateOf(SwingAt(t_s));
    const CarrierState after = CarrierStateOf(SwingAt(t_s + kStep));
    const auto slope = [&](const auto& a, const auto& b) {
      return Eigen::Vector3d((b - a) / (2.0 * kStep));
    };
    EXPECT_LT((slope(before.T_b_e.t, after.T_b_e.t) - state.velocity_b).norm(), 1e-8);
    EXPECT_LT((slope(before.velocity_b, after.velocity_b) - state.acceleration_b).norm(), 1e-8);
    EXPECT_LT((after.T_b_e.DifferenceTo(before.T_b_e).head<3>() / (2.0 * kStep) -
               state.angular_velocity_b)
                  .norm(),
              1e-8);
    EXPECT_LT(
        (slope(before.angular_velocity_b, after.angular_velocity_b) - state.angular_acceleration_b)
            .norm(),
        1e-8);
  }
}

// A loop whose joints jump to and fro by up to 0.4 rad from way-point to way-point.
JointPath RestlessPath() {
  JointPath path;
  Rng rng(1);
  const auto draw = [&] {
    JointVector q;
    for (double& x : q) x = 0.4 * rng.Uniform();
    return q;
  };
  path.start = draw();
  for (JointVector& q : path.loops.emplace_back()) q = draw();
  return path;
}

TEST(LoopJointSpline, SaysHowFarItSwingsBeyondItsWayPoints) {
  const JointPath path = RestlessPath();
  const LoopJointSpline spline(path, 0);
  double farthest = 0.0;
  for (int i = 1; i <= kNumWayPoints; ++i) {
    const JointRange range = spline.RangeOnTheWayTo(i);
    JointRange sampled{path.At(0, i), path.At(0, i)};
    constexpr int kNumSamples = 1000;
    for (int k = 0; k <= kNumSamples; ++k) {
      const double theta = WayPointPhase(i - 1) + WayPointPhase(1) * k / kNumSamples;
      const JointVector q = spline.At({theta, 0.0, 0.0, 0.0}).position;
      sampled.lower = sampled.lower.cwiseMin(q);
      sampled.upper = sampled.upper.cwiseMax(q);
    }
    EXPECT_LT((range.lower - sampled.lower).cwiseAbs().maxCoeff(), 1e-5) << i;
    EXPECT_LT((range.upper - sampled.upper).cwiseAbs().maxCoeff(), 1e-5) << i;
    EXPECT_LE((range.lower - sampled.lower).maxCoeff(), 1e-12) << i;
    const JointVector highest_end = path.At(0, i).cwiseMax(path.At(0, i - 1));
    farthest = std::max(farthest, (range.upper - highest_end).maxCoeff());
  }
  EXPECT_GT(farthest, 0.05);
}

TEST(LoopJointSpline, StandsWhereItsWayPointsAreOne) {
  JointPath path;
  path.start = JointVector::Constant(0.3);
  path.loops.emplace_back().fill(path.start);
  const JointRange range = LoopJointSpline(path, 0).RangeOnTheWayTo(1);
  EXPECT_LT((range.lower - path.start).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LT((range.upper - path.start).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(JointTrajectory, StaysOnTheLoopsBetweenWayPoints) {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = Carrier::kArm;
  const TimedMotion timed = std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
  const JointTrajectory trajectory(timed);
  constexpr double kStep = 1e-5;
  for (double t_s = 0.013; t_s < timed.duration_s(); t_s += 0.037) {
    const JointMotion joints = trajectory.At(t_s);
    const CarrierState wanted = timed.At(t_s);
    const Eigen::Matrix<double, 6, 1> error =
        PandaPose(joints.position, nullptr).DifferenceTo(wanted.T_b_e);
    EXPECT_LT(error.head<3>().norm(), 2e-4) << t_s;
    EXPECT_LT(error.tail<3>().norm(), 1e-4) << t_s;
    const JointMotion before = trajectory.At(t_s - kStep);
    const JointMotion after = trajectory.At(t_s + kStep);
    EXPECT_LT(((after.position - before.position) / (2.0 * kStep) - joints.velocity).norm(), 1e-6);
    EXPECT_LT(((after.velocity - before.velocity) / (2.0 * kStep) - joints.acceleration).norm(),
              1e-3);
  }
}

TEST(JointTrajectory, RestsAtTheStartBetweenLoopsAndAtTheEnd) {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = Carrier::kArm;
  const TimedMotion timed = std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
  const JointTrajectory trajectory(timed);
  for (const double t_s : {-1.0, 0.0, 5.0, 10.0, 15.0, 16.0}) {
    const JointMotion joints = trajectory.At(t_s);
    EXPECT_LT((joints.position - timed.joint_path.back().position).norm(), 1e-12) << t_s;
    EXPECT_LT(joints.velocity.norm(), 1e-12) << t_s;
    EXPECT_LT(joints.acceleration.norm(), 1e-12) << t_s;
  }
}

}  // namespace
}  // namespace calibrato
