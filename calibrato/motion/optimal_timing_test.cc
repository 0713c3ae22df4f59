#include "calibrato/motion/optimal_timing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/motion/joint_motion.h"
#include "calibrato/motion/joint_timing.h"
#include "calibrato/motion/panda_dynamics.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

TEST(FastestTimeLaw, OfOneJointIsTheTrapezoidButForItsSmoothing) {
  constexpr double kRate = 0.3;  // q = kRate theta
  constexpr double kVelocity = 1.0;
  constexpr double kAcceleration = 2.0;
  const auto limits_at = [](double) {
    const double max_speed = kVelocity / kRate;
    return PhaseLimits{max_speed * max_speed,
                       {{kRate, 0.0, kAcceleration}, {-kRate, 0.0, kAcceleration}}};
  };
  const auto stretch = [](const TimeLaw& law) {
    double needed = 1.0;
    for (int k = 0; k <= 10'000; ++k) {
      const Phase phase = PhaseAt(law, law.duration_s * k / 10'000);
      needed = std::max({needed, kRate * phase.first / kVelocity,
                         std::sqrt(kRate * std::abs(phase.second) / kAcceleration)});
    }
    return needed;
  };
  const double trapezoid_s = kRate * kTurn / kVelocity + kVelocity / kAcceleration;
  EXPECT_NEAR(LeastDuration(limits_at), trapezoid_s, 1e-3);
  const TimeLaw law = FastestTimeLaw(limits_at, stretch);
  EXPECT_FALSE(law.control_points.empty());
  EXPECT_GT(law.duration_s, trapezoid_s);
  EXPECT_LT(law.duration_s, trapezoid_s + 0.03);
}

TEST(FastestTimeLaw, OfALoopOfMinutesHasNoMoreThanTenThousandPieces) {
  // 1e-4 rad/s^2 of the phase: T = 2 sqrt(2 pi / 1e-4) = 501 s.
  const auto limits_at = [](double) {
    return PhaseLimits{1.0, {{1.0, 0.0, 1e-4}, {-1.0, 0.0, 1e-4}}};
  };
  const TimeLaw law = FastestTimeLaw(limits_at, [](const TimeLaw& law) {
    return law.control_points.empty() ? 2000.0 : 1.0;  // the quintic needs 1000 s
  });
  EXPECT_EQ(law.control_points.size(), 10'005u);
  EXPECT_NEAR(law.duration_s, 2.0 * std::sqrt(kTurn / 1e-4), 0.2);
}

TEST(FastestTimeLaw, OfALoopThatStandsStillTakesTheShortestTime) {
  for (const Carrier carrier : {Carrier::kFree, Carrier::kArm}) {
    Motion still;
    still.carrier = carrier;
    still.timing = Timing::kOptimal;
    still.loops.resize(1);
    EXPECT_EQ(std::get<TimedMotion>(PlanMotion(still, PaperRig())).duration_s(), kShortestLoop);
  }
}

TEST(FastestTimeLaw, IsTheQuinticWhereNothingElseIsKnown) {
  // Rest is forbidden to the linear limits; the stretch knows better.
  const auto limits_at = [](double) { return PhaseLimits{1.0, {{0.0, 1.0, -1.0}}}; };
  const TimeLaw law = FastestTimeLaw(limits_at, [](const TimeLaw&) { return 4.0; });
  EXPECT_TRUE(law.control_points.empty());
  EXPECT_EQ(law.duration_s, 4.0 * kShortestLoop);
}

Motion OnArm(Motion motion, Timing timing) {
  motion.carrier = Carrier::kArm;
  motion.timing = timing;
  return motion;
}

// The largest share of each limit at 1 kHz.
struct Shares {
  double position = 0.0;  // beyond the limits [rad]; negative inside
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
  double torque = 0.0;
};
Shares SharesOf(const TimedMotion& timed) {
  const JointTrajectory trajectory(timed);
  const PandaLimits& limits = Limits();
  Shares shares{.position = -10.0};
  const auto largest = [](const JointVector& values, const JointVector& bounds) {
    return values.cwiseAbs().cwiseQuotient(bounds).maxCoeff();
  };
  const auto num_steps = static_cast<int>(std::ceil(1e3 * timed.duration_s()));
  for (int k = 0; k <= num_steps; ++k) {
    const JointMotion joints = trajectory.At(1e-3 * k);
    shares.position = std::max(shares.position, JointLimitExcess(joints.position));
    shares.velocity = std::max(shares.velocity, largest(joints.velocity, limits.velocity));
    shares.acceleration =
        std::max(shares.acceleration, largest(joints.acceleration, limits.acceleration));
    shares.jerk = std::max(shares.jerk, largest(joints.jerk, limits.jerk));
    const JointVector torque = PandaTorque(joints.position, joints.velocity, joints.acceleration);
    shares.torque = std::max(shares.torque, largest(torque, limits.torque));
  }
  return shares;
}

void ExpectWithinLimits(const TimedMotion& timed, Shares* worst) {
  const Shares shares = SharesOf(timed);
  constexpr double kWhole = 1.0 + 1e-4;  // what lies between the planner's own instants
  EXPECT_LE(shares.position, 0.0);
  EXPECT_LE(shares.velocity, kWhole);
  EXPECT_LE(shares.acceleration, kWhole);
  EXPECT_LE(shares.jerk, kWhole);
  EXPECT_LE(shares.torque, kWhole);
  worst->position = std::max(worst->position, shares.position);
  worst->velocity = std::max(worst->velocity, shares.velocity);
  worst->acceleration = std::max(worst->acceleration, shares.acceleration);
  worst->jerk = std::max(worst->jerk, shares.jerk);
  worst->torque = std::max(worst->torque, shares.torque);
}

void ExpectRestAtEveryEnd(const TimedMotion& timed) {
  const JointTrajectory trajectory(timed);
  double end_s = 0.0;
  for (size_t loop = 0; loop <= timed.loop_duration_s.size(); ++loop) {
    const JointMotion joints = trajectory.At(end_s);
    EXPECT_LT((joints.position - timed.joint_path.back().position).norm(), 1e-9);
    EXPECT_LT(joints.velocity.norm(), 1e-9);
    EXPECT_LT(joints.acceleration.norm(), 1e-9);
    if (loop < timed.loop_duration_s.size()) end_s += timed.loop_duration_s[loop];
  }
}

// The same joint path as fast as the quintic can be.
double FastestQuintic(const TimedMotion& timed) {
  JointPath path;
  path.start = timed.joint_path.back().position;
  auto sample = timed.joint_path.begin();
  double sum_s = 0.0;
  for (size_t loop = 0; loop < timed.motion.loops.size(); ++loop) {
    for (JointVector& q : path.loops.emplace_back()) q = (sample++)->position;
    ++sample;
  }
  for (size_t loop = 0; loop < path.loops.size(); ++loop) {
    sum_s += kShortestLoop * SmallestStretch(path, loop, {kShortestLoop, {}});
  }
  return sum_s;
}

TEST(JointLimits, HoldAt1kHzUnderBothTimings) {
  const int num_random = FullSample() ? 100 : 2;
  for (const Timing timing : {Timing::kQuintic, Timing::kOptimal}) {
    Rng rng(20);
    std::vector<Motion> motions = {HandcraftedMotion(Task::kExtrinsic)};
    for (int i = 0; i < num_random; ++i) {
      motions.push_back(RandomMotion(i % 2 == 0 ? Task::kIntrinsic : Task::kExtrinsic, rng));
    }
    Shares worst{.position = -10.0};
    double optimal_s = 0.0;
    double quintic_s = 0.0;
    double least_s = 0.0;
    for (const Motion& motion : motions) {
      const TimedMotion timed =
          std::get<TimedMotion>(PlanMotion(OnArm(motion, timing), PaperRig()));
      ExpectWithinLimits(timed, &worst);
      ExpectRestAtEveryEnd(timed);
      if (timing == Timing::kQuintic) continue;
      EXPECT_LE(timed.duration_s(), FastestQuintic(timed) * (1.0 + 1e-9));
      optimal_s += timed.duration_s();
      quintic_s += FastestQuintic(timed);
      JointPath path;
      path.start = timed.joint_path.back().position;
      auto sample = timed.joint_path.begin();
      for (size_t loop = 0; loop < timed.motion.loops.size(); ++loop) {
        for (JointVector& q : path.loops.emplace_back()) q = (sample++)->position;
        ++sample;
        const LoopJointSpline spline(path, loop);
        least_s += LeastDuration([&](double theta) { return PhaseLimitsOfJoints(spline, theta); });
      }
    }
    if (FullSample()) {
      std::printf(
          "%s: to the nearest limit %.4f rad; largest shares velocity %.3f, acceleration %.3f, "
          "jerk %.3f, torque %.3f\n",
          TimingName(timing).c_str(), -worst.position, worst.velocity, worst.acceleration,
          worst.jerk, worst.torque);
      if (timing == Timing::kOptimal) {
        std::printf(
            "optimal %.1f s, fastest quintic %.1f s, least with jumps of acceleration %.1f s\n",
            optimal_s, quintic_s, least_s);
      }
    }
  }
}

TEST(FastestTimeLaw, KeepsTheFreeCarriersLimitsAndIsFasterThanTheQuintic) {
  const FreeCarrierLimits limits;
  Rng rng(3);
  for (int i = 0; i < 6; ++i) {
    Motion motion = RandomMotion(Task::kExtrinsic, rng);
    motion.timing = Timing::kOptimal;
    const TimedMotion optimal = std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
    motion.timing = Timing::kQuintic;
    for (Loop& loop : motion.loops) loop.duration_s = kShortestLoop;
    const TimedMotion quintic = std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
    EXPECT_LT(optimal.duration_s(), 0.95 * quintic.duration_s());
    for (double t_s = 0.0; t_s <= optimal.duration_s(); t_s += 1e-3) {
      const CarrierState state = optimal.At(t_s);
      EXPECT_LE(state.velocity_b.norm(), limits.speed * 1.0001);
      EXPECT_LE(state.acceleration_b.norm(), limits.acceleration * 1.0001);
      EXPECT_LE(state.angular_velocity_b.norm(), limits.angular_speed * 1.0001);
      EXPECT_LE(state.angular_acceleration_b.norm(), limits.angular_acceleration * 1.0001);
    }
  }
}

}  // namespace
}  // namespace calibrato
