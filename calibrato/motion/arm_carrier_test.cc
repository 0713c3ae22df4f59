#include "calibrato/motion/arm_carrier.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/rpy.h"
#include "calibrato/motion/arm_clearance.h"
#include "calibrato/motion/joint_motion.h"
#include "calibrato/motion/joint_path_cost.h"
#include "calibrato/motion/joint_path_refinement.h"
#include "calibrato/motion/joint_path_search.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/motion/singularity.h"
#include "calibrato/motion/way_point.h"

namespace calibrato {
namespace {

Motion OnArm(Motion motion) {
  motion.carrier = Carrier::kArm;
  return motion;
}

Motion OneLoop(int coefficient, double value) {
  Motion motion;
  motion.carrier = Carrier::kArm;
  motion.loops.emplace_back();
  motion.loops[0].coefficients[coefficient] = value;
  return motion;
}

// The joint limits that plans keep, 1 mrad inside the arm's.
JointRange PlannedRange() {
  const JointVector margin = JointVector::Constant(1e-3);
  return {.lower = Limits().lower + margin, .upper = Limits().upper - margin};
}

// The least excess over them of all ways to stand at a pose, found without any path.
double LeastExcess(const Rigid3& T_b_e) {
  constexpr int kGridSize = 1000;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kGridSize; ++i) {
    const double q7 = Limits().lower[6] + (Limits().upper[6] - Limits().lower[6]) * i / kGridSize;
    for (const JointVector& q : PandaInverse(T_b_e, q7))
      least = std::min(least, JointLimitExcess(q, PlannedRange()));
  }
  return least;
}

// Of so many instants from one way-point to the next.
int NumBeyondLimits(const Loop& loop, int instants_per_way_point = 1) {
  int count = 0;
  for (int i = 1; i <= kNumWayPoints * instants_per_way_point; ++i) {
    const double theta = WayPointPhase(1) * i / instants_per_way_point;
    count += LeastExcess(LoopPoseAt(BasePose(), loop.coefficients, theta)) > 1e-4;
  }
  return count;
}

void ExpectJointPathFollowsTheMotion(const TimedMotion& timed) {
  ASSERT_EQ(timed.joint_path.size(), kNumWayPoints * timed.motion.loops.size());
  const JointVector start = timed.joint_path.back().position;
  JointVector previous = start;
  double previous_t_s = 0.0;
  for (size_t i = 0; i < timed.joint_path.size(); ++i) {
    const auto& [t_s, q] = timed.joint_path[i];
    EXPECT_GT(t_s, previous_t_s);
    EXPECT_LE(JointLimitExcess(q), 0.0);
    EXPECT_LT(PandaPose(q, nullptr).DifferenceTo(timed.At(t_s).T_b_e).norm(), 1e-8);
    EXPECT_LT((q - previous).cwiseAbs().maxCoeff(), kMaxJointStep);
    if ((i + 1) % kNumWayPoints == 0) {
      EXPECT_EQ(q, start);
    }
    previous = q;
    previous_t_s = t_s;
  }
  EXPECT_NEAR(previous_t_s, timed.duration_s(), 1e-9);
}

TEST(ArmCarrier, MakesTheExtrinsicHandcraftedMotionAtFullSpeed) {
  const auto plan = PlanMotion(OnArm(HandcraftedMotion(Task::kExtrinsic)), PaperRig());
  ASSERT_TRUE(std::holds_alternative<TimedMotion>(plan)) << std::get<Refusal>(plan).Describe();
  const TimedMotion& timed = std::get<TimedMotion>(plan);
  ExpectJointPathFollowsTheMotion(timed);
  EXPECT_EQ(timed.duration_s(), 15.0);
}

TEST(ArmCarrier, MakesRandomMotions) {
  const int num_motions = std::getenv("CALIBRATO_FULL_SAMPLE") != nullptr ? 50 : 4;
  Rng rng(1);
  for (int i = 0; i < num_motions; ++i) {
    const Motion motion =
        OnArm(RandomMotion(i % 2 == 0 ? Task::kIntrinsic : Task::kExtrinsic, rng));
    const auto plan = PlanMotion(motion, PaperRig());
    ASSERT_TRUE(std::holds_alternative<TimedMotion>(plan)) << std::get<Refusal>(plan).Describe();
    ExpectJointPathFollowsTheMotion(std::get<TimedMotion>(plan));
  }
}

TEST(ArmCarrier, RefusesExactlyTheWayPointsOfTheIntrinsicHandcraftedMotionThatNoJointsReach) {
  const Motion motion = OnArm(HandcraftedMotion(Task::kIntrinsic));
  const auto plan = PlanMotion(motion, PaperRig());
  ASSERT_TRUE(std::holds_alternative<Refusal>(plan));
  const Refusal& refusal = std::get<Refusal>(plan);
  int num_bad_way_points = 0;
  for (const Loop& loop : motion.loops) num_bad_way_points += NumBeyondLimits(loop);
  EXPECT_EQ(num_bad_way_points, 5);
  EXPECT_EQ(refusal.num_bad_way_points, num_bad_way_points);
  EXPECT_EQ(refusal.loop, 3);
  EXPECT_EQ(refusal.limit.substr(0, 6), "joint ");
  const Rigid3 T_b_e = LoopPoseAt(BasePose(), motion.loops[refusal.loop].coefficients,
                                  WayPointPhase(refusal.way_point));
  EXPECT_NEAR(std::abs(refusal.value - refusal.bound), LeastExcess(T_b_e), 2e-3);
}

TEST(ArmCarrier, ScalesTheIntrinsicHandcraftedMotionToTheLargestFactorThatAnyJointsReach) {
  // Its last loop alone decides the factor, and is planned in a quarter of the time.
  Motion motion = OnArm(HandcraftedMotion(Task::kIntrinsic));
  motion.loops.erase(motion.loops.begin(), motion.loops.end() - 1);
  const TimedMotion timed = PlanScaledToFit(motion, PaperRig());
  // A scan of all joint angles at four instants a way-point gives 0.8763.
  EXPECT_NEAR(timed.scale, 0.8763, 1e-3);
  ExpectJointPathFollowsTheMotion(timed);
  // Somewhere on the way, if not at a way-point, a motion larger by the tolerance has no joint
  // angles within the limits.
  Loop larger = timed.motion.loops[0];
  larger.coefficients *= 1.0 + 2e-3;
  EXPECT_GT(NumBeyondLimits(larger, 4), 0);
}

TEST(ArmCarrier, RefusesPosesOutOfReach) {
  const auto plan = PlanMotion(OneLoop(1, 0.5), PaperRig());
  ASSERT_TRUE(std::holds_alternative<Refusal>(plan));
  const Refusal& refusal = std::get<Refusal>(plan);
  EXPECT_EQ(refusal.limit, "way beyond the reach of the arm");
  EXPECT_GT(refusal.value, 0.0);
  EXPECT_EQ(refusal.unit, "m");
}

TEST(ArmCarrier, RefusesToLoseTheBoard) {
  const auto plan = PlanMotion(OneLoop(31, 0.6), PaperRig());
  ASSERT_TRUE(std::holds_alternative<Refusal>(plan));
  EXPECT_EQ(std::get<Refusal>(plan).limit, "board in view");
}

void ExpectRefusal(const Motion& motion, const Rig& rig, const std::string& limit) {
  const auto plan = PlanMotion(motion, rig);
  ASSERT_TRUE(std::holds_alternative<Refusal>(plan));
  const Refusal& refusal = std::get<Refusal>(plan);
  EXPECT_NE(refusal.limit.find(limit), std::string::npos) << refusal.Describe();
}

TEST(ArmCarrier, RefusesToRunIntoTheTable) {
  Motion motion = OneLoop(15, 0.01);
  motion.base_pose.xyz_m.z() = 0.03;
  motion.base_pose.rpy_rad = {1.5708, 0.8, 1.5708};
  Rig rig = PaperRig();
  rig.T_w_g.t.z() -= 0.44;
  ExpectRefusal(motion, rig, "to table");
}

TEST(ArmCarrier, RefusesToRunIntoTheBoard) {
  Rig rig = PaperRig();
  // 80 mm before the camera.
  const Rigid3 T_w_c0 =
      ArmBaseInWorld() * LoopPoseAt(BasePose(), LoopCoefficients::Zero(), 0.0) * rig.T_e_c0;
  rig.T_w_g.t += T_w_c0 * Eigen::Vector3d(0.0, 0.0, 0.08) - rig.T_w_g * BoardCentre(rig.board);
  ExpectRefusal(OneLoop(2, -0.03), rig, "to board");
}

TEST(ArmCarrier, RefusesToEnterABoxAndPassesBesideIt) {
  const Motion motion = OnArm(HandcraftedMotion(Task::kExtrinsic));
  Rig rig = PaperRig();
  rig.arm_limits.keep_out = {
      {"lamp", {Eigen::Matrix3d::Identity(), {0.35, 0.25, 0.47}}, {0.05, 0.05, 0.05}}};
  ExpectRefusal(motion, rig, "to lamp");
  rig.arm_limits.keep_out[0].T_b_box.t.z() = 1.4;
  EXPECT_TRUE(std::holds_alternative<TimedMotion>(PlanMotion(motion, rig)));
}

// Of the whole way, at 50 instants a second.
double LeastClearance(const TimedMotion& timed, const Rig& rig) {
  const ClearanceCheck check(rig);
  const JointTrajectory trajectory(timed);
  double least = std::numeric_limits<double>::infinity();
  for (double t_s = 0.0; t_s < timed.duration_s(); t_s += 0.02) {
    least = std::min(least, check.Least(trajectory.At(t_s).position).distance_m);
  }
  return least;
}

// All joint paths that a search finds which knows of no obstacle.
std::vector<JointPath> PathsWithoutObstacles(const Motion& motion) {
  PosePath poses;
  poses.start = LoopPoseAt(motion.base_pose, LoopCoefficients::Zero(), 0.0);
  for (const Loop& loop : motion.loops) {
    PosePath::Loop& loop_poses = poses.loops.emplace_back();
    for (int i = 1; i < kNumWayPoints; ++i) {
      loop_poses[i - 1] = LoopPoseAt(motion.base_pose, loop.coefficients, WayPointPhase(i));
    }
  }
  const auto search = SearchJointPaths(JointChoicesAlong(poses), {});
  std::vector<JointPath> paths = std::get<std::vector<JointPath>>(search);
  for (JointPath& path : paths) path = RefineJointPath(poses, path, {});
  return paths;
}

TEST(ArmCarrier, SwingsTheElbowOutOfTheWayOfBoxes) {
  // Small boxes in every place where the elbow would be: without a search that sees them there is
  // no way left.
  const Motion motion = OnArm(HandcraftedMotion(Task::kExtrinsic));
  const std::vector<JointPath> paths = PathsWithoutObstacles(motion);
  Rig rig = PaperRig();
  for (const JointPath& path : paths) {
    Rigid3 T_b_box;
    T_b_box.t = AxesOf(path.start).T_b_link[3].t;
    rig.arm_limits.keep_out.push_back({"beam", T_b_box, {0.02, 0.02, 0.02}});
  }
  const ClearanceCheck check(rig);
  for (const JointPath& path : paths) EXPECT_LT(check.Least(path.start).distance_m, 0.0);
  const auto plan = PlanMotion(motion, rig);
  ASSERT_TRUE(std::holds_alternative<TimedMotion>(plan)) << std::get<Refusal>(plan).Describe();
  const TimedMotion& swung = std::get<TimedMotion>(plan);
  EXPECT_GE(LeastClearance(swung, rig), rig.arm_limits.clearance_m - 1e-4);
  ExpectJointPathFollowsTheMotion(swung);
}

// The board so far before the camera at the motion's base pose that it stays in view.
Rig WithBoardBefore(const BasePose& base) {
  Rig rig = PaperRig();
  const Rigid3 T_w_c0 =
      ArmBaseInWorld() * LoopPoseAt(base, LoopCoefficients::Zero(), 0.0) * rig.T_e_c0;
  rig.T_w_g.t += T_w_c0 * Eigen::Vector3d(0.0, 0.0, 1.2) - rig.T_w_g * BoardCentre(rig.board);
  return rig;
}

TEST(ArmCarrier, RefusesToReachOutUntilTheWristIsSingular) {
  // Outwards to within a millimetre of where no joint angles reach.
  const auto reaches = [](double way) {
    const Motion motion = OneLoop(0, -0.5 * way);
    const Rigid3 pose =
        LoopPoseAt(motion.base_pose, motion.loops[0].coefficients, std::numbers::pi);
    double shortfall = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= 1000; ++i) {
      const double q7 = Limits().lower[6] + (Limits().upper[6] - Limits().lower[6]) * i / 1000;
      shortfall = std::min(shortfall, PandaShortfall(pose, q7));
    }
    return shortfall == 0.0;
  };
  double inside = 0.0;
  double outside = 1.0;
  while (outside - inside > 1e-4) {
    const double middle = 0.5 * (inside + outside);
    (reaches(middle) ? inside : outside) = middle;
  }
  const Motion motion = OneLoop(0, -0.5 * (inside - 5e-4));
  const auto plan = PlanMotion(motion, WithBoardBefore(motion.base_pose));
  ASSERT_TRUE(std::holds_alternative<Refusal>(plan));
  const Refusal& refusal = std::get<Refusal>(plan);
  // There axes 5 and 7 come into line before the elbow is stretched.
  EXPECT_NE(refusal.limit.find("near a singular wrist"), std::string::npos) << refusal.Describe();
  EXPECT_EQ(refusal.loop, 0);
  EXPECT_GT(refusal.way_point, 15);
  EXPECT_LE(refusal.way_point, 31);
  EXPECT_NE(refusal.remedy.find("base_pose"), std::string::npos);
}

TEST(ArmCarrier, StandsElsewhereThanInASingularWristOrShoulder) {
  // Two postures that are singular, each of a pose that others reach as well. A loop through that
  // pose keeps away from them.
  JointVector wrist;
  wrist << 0.099, 0.0, 1.423, -1.356, 2.493, 0.0, 2.2;
  JointVector shoulder;
  shoulder << 0.2, 0.0, 0.5 * std::numbers::pi, -2.0, 0.3, 1.8, 0.7;
  for (const JointVector& singular : {wrist, shoulder}) {
    EXPECT_LT(SingularityDistance(singular), 0.2 * kMinSingularityDistance);
    const Rigid3 T_b_e = PandaPose(singular, nullptr);
    Motion motion = OneLoop(15, 0.02);
    motion.loops[0].coefficients[24] = 0.05;
    motion.base_pose = {T_b_e.t, RpyFromRotation(T_b_e.R)};
    const auto plan = PlanMotion(motion, WithBoardBefore(motion.base_pose));
    ASSERT_TRUE(std::holds_alternative<TimedMotion>(plan)) << std::get<Refusal>(plan).Describe();
    const TimedMotion& timed = std::get<TimedMotion>(plan);
    ExpectJointPathFollowsTheMotion(timed);
    for (const JointSample& sample : timed.joint_path) {
      EXPECT_GE(SingularityDistance(sample.position), kMinSingularityDistance);
    }
  }
}

TEST(ArmCarrier, KeepsTheUsersJointLimits) {
  const Motion motion = OnArm(HandcraftedMotion(Task::kExtrinsic));
  const TimedMotion free = std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
  JointVector highest = free.joint_path[0].position;
  for (const JointSample& sample : free.joint_path) highest = highest.cwiseMax(sample.position);
  // Just below where the free plan goes: the redundancy gives way.
  Rig rig = PaperRig();
  rig.arm_limits.joint_upper[6] = highest[6] - 0.05;
  const auto plan = PlanMotion(motion, rig);
  ASSERT_TRUE(std::holds_alternative<TimedMotion>(plan)) << std::get<Refusal>(plan).Describe();
  for (const JointSample& sample : std::get<TimedMotion>(plan).joint_path) {
    EXPECT_LE(sample.position[6], rig.arm_limits.joint_upper[6]);
  }
  // An elbow that can't bend enough: the pose decides its angle, nothing gives way.
  rig.arm_limits.joint_lower[3] = -1.0;
  ExpectRefusal(motion, rig, "joint 4 lower limit");
}

// The most that the elbow can bend at a pose, whatever the redundancy does.
double MostBentElbow(const Rigid3& T_b_e) {
  constexpr int kGridSize = 1000;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kGridSize; ++i) {
    const double q7 = Limits().lower[6] + (Limits().upper[6] - Limits().lower[6]) * i / kGridSize;
    for (const JointVector& q : PandaInverse(T_b_e, q7)) {
      if (JointLimitExcess(q) <= 0.0) least = std::min(least, q[3]);
    }
  }
  return least;
}

TEST(ArmCarrier, KeepsJointLimitsBetweenWayPointsToo) {
  // The arm reaches out farthest half-way between way-points 15 and 16.
  Motion motion = OneLoop(1, 0.05);
  motion.loops[0].coefficients[4] = 0.04;
  const auto elbow_at = [&](double way_point) {
    return MostBentElbow(
        LoopPoseAt(motion.base_pose, motion.loops[0].coefficients, WayPointPhase(1) * way_point));
  };
  const double at_way_points = elbow_at(16.0);
  const double between = elbow_at(15.5);
  ASSERT_GT(between, at_way_points + 2e-3);
  for (int i = 0; i < kNumWayPoints; ++i) ASSERT_LE(elbow_at(i), at_way_points);
  Rig rig = PaperRig();
  rig.arm_limits.joint_upper[3] = 0.5 * (at_way_points + between);
  const auto plan = PlanMotion(motion, rig);
  ASSERT_TRUE(std::holds_alternative<Refusal>(plan));
  const Refusal& refusal = std::get<Refusal>(plan);
  EXPECT_EQ(refusal.limit, "joint 4 upper limit");
  EXPECT_EQ(refusal.way_point, 16);
  EXPECT_EQ(refusal.num_bad_way_points, 1);
  EXPECT_NEAR(refusal.value, between, 1e-3);
  // A little above it there is a path, and it stays below all the time.
  rig.arm_limits.joint_upper[3] = between + 1e-3;
  const auto higher = PlanMotion(motion, rig);
  ASSERT_TRUE(std::holds_alternative<TimedMotion>(higher)) << std::get<Refusal>(higher).Describe();
  const TimedMotion& timed = std::get<TimedMotion>(higher);
  const JointTrajectory trajectory(timed);
  for (double t_s = 0.0; t_s < timed.duration_s(); t_s += 1e-3) {
    ASSERT_LE(trajectory.At(t_s).position[3], rig.arm_limits.joint_upper[3]) << t_s;
  }
}

TEST(ArmCarrier, KeepsTheWristFromTurningTooFar) {
  Rig rig = PaperRig();
  rig.arm_limits.max_wrist_turn = 0.01;
  ExpectRefusal(OnArm(HandcraftedMotion(Task::kExtrinsic)), rig, "turn of the wrist");
}

TEST(ArmCarrier, RefusesNotANumber) {
  EXPECT_TRUE(std::holds_alternative<Refusal>(PlanMotion(OneLoop(0, std::nan("")), PaperRig())));
}

TEST(ArmCarrier, PlansTheSamePathTwice) {
  const Motion motion = OnArm(HandcraftedMotion(Task::kExtrinsic));
  const auto first = PlanMotion(motion, PaperRig());
  const auto second = PlanMotion(motion, PaperRig());
  for (size_t i = 0; i < std::get<TimedMotion>(first).joint_path.size(); ++i) {
    EXPECT_EQ(std::get<TimedMotion>(first).joint_path[i].position,
              std::get<TimedMotion>(second).joint_path[i].position);
  }
}

TEST(ArmCarrier, RefusesToScaleAroundABasePoseOutOfReach) {
  Motion motion = OneLoop(1, 0.1);
  motion.base_pose.xyz_m.x() = 1.2;
  EXPECT_THROW((void)PlanScaledToFit(motion, PaperRig()), InputError);
}

}  // namespace
}  // namespace calibrato
