#include "calibrato/motion/arm_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/input_error.h"
#include "calibrato/motion/arm_file.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/motion/robot_formats.h"

namespace calibrato {
namespace {

Arm Example(const std::string& name) { return ReadArm("examples/arms/" + name + ".yaml", nullptr); }

// The paper's rig on this arm, its board upright, 1.2 m before the camera at the arm's start.
Rig RigBefore(const Arm& arm) {
  Rig rig = PaperRig();
  const Rigid3 T_w_c0 = ArmBaseInWorld() * PoseOf(arm, arm.start, nullptr) * rig.T_e_c0;
  Rigid3 T_c0_g;
  T_c0_g.R << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
  T_c0_g.t = Eigen::Vector3d(0.0, 0.0, 1.2) - T_c0_g.R * BoardCentre(rig.board);
  rig.T_w_g = T_w_c0 * T_c0_g;
  return rig;
}

Motion SmallRandomMotion(const Arm& arm, Rng& rng) {
  Motion motion = RandomMotion(Task::kExtrinsic, rng);
  motion.base_pose = StartPose(arm);
  return motion;
}

double LargestShare(const JointVector& values, const JointVector& limits) {
  return values.cwiseAbs().cwiseQuotient(limits).maxCoeff();
}

TEST(PlanOnDescribedArm, KeepsLimitsAt1kHzAndMakesThePoses) {
  const int num_motions = FullSample() ? 20 : 1;
  for (const std::string name : {"ur5e", "xarm6", "xarm7"}) {
    const Arm arm = Example(name);
    const Rig rig = RigBefore(arm);
    Rng rng(9);
    for (int i = 0; i < num_motions; ++i) {
      Motion motion = SmallRandomMotion(arm, rng);
      motion.timing = i % 2 == 0 ? Timing::kQuintic : Timing::kOptimal;
      if (motion.timing == Timing::kQuintic) {
        // Asked for more quickly than any arm can.
        for (Loop& loop : motion.loops) loop.duration_s = 0.5;
      }
      const TimedMotion timed = PlanScaledToFit(arm, motion, rig);
      double nearest = 0.0;
      const std::vector<JointMotion> samples = JointSamples(timed, 1000);
      for (size_t k = 0; k < samples.size(); ++k) {
        const JointMotion& joints = samples[k];
        ASSERT_LE(JointLimitExcess(joints.position, {arm.limits.lower, arm.limits.upper}), 0.0);
        nearest = std::max({nearest, LargestShare(joints.velocity, arm.limits.velocity),
                            LargestShare(joints.acceleration, arm.limits.acceleration),
                            LargestShare(joints.jerk, arm.limits.jerk)});
        if (k % 50 != 0) continue;
        const Rigid3 wanted = timed.At(1e-3 * static_cast<double>(k)).T_b_e;
        const Rigid3 reached = PoseOf(arm, joints.position, nullptr);
        // Between way-points the joints follow splines.
        EXPECT_LT(wanted.DifferenceTo(reached).norm(), 1e-3) << name;
      }
      EXPECT_LE(nearest, 1.001) << name;
      EXPECT_GT(nearest, 0.9) << name;  // as quick as that allows
      for (const JointMotion& end : {samples.front(), samples.back()}) {
        EXPECT_LT(end.velocity.norm() + end.acceleration.norm(), 1e-6) << name;
      }
      EXPECT_LT((samples.front().position - samples.back().position).norm(), 1e-9) << name;
    }
  }
}

TEST(PlanOnDescribedArm, KeepsOutOfWhatItsOwnerForbids) {
  const Arm arm = Example("ur5e");
  Rig rig = RigBefore(arm);
  Rng rng(10);
  const Motion motion = SmallRandomMotion(arm, rng);
  const TimedMotion timed = PlanScaledToFit(arm, motion, rig);
  // A box where the hand is.
  rig.arm_limits.keep_out.push_back(
      {"box", {Eigen::Matrix3d::Identity(), motion.base_pose.xyz_m}, {0.1, 0.1, 0.1}});
  const auto refused = PlanOnArm(arm, timed.motion, rig);
  ASSERT_TRUE(std::holds_alternative<Refusal>(refused));
  EXPECT_NE(std::get<Refusal>(refused).limit.find("to box"), std::string::npos)
      << std::get<Refusal>(refused).limit;
  EXPECT_THROW((void)PlanScaledToFit(arm, motion, rig), InputError);
  // Out of reach is said so.
  rig.arm_limits.keep_out.clear();
  Motion far = motion;
  far.loops[0].coefficients[2] = 1.0;
  EXPECT_TRUE(std::holds_alternative<Refusal>(PlanOnArm(arm, far, rig)));
}

TEST(RobotFile, HasTheJointsOfTheArm) {
  const Arm arm = Example("xarm6");
  const Rig rig = RigBefore(arm);
  Rng rng(11);
  const TimedMotion timed = PlanScaledToFit(arm, SmallRandomMotion(arm, rng), rig);
  RobotNames names{{}, arm.base_frame};
  for (const Arm::Joint& joint : arm.joints) names.joints.push_back(joint.name);
  const std::string csv = RobotFile(timed, RobotFormat::kJointCsv, names);
  const std::string head = csv.substr(0, csv.find('\n'));
  EXPECT_NE(head.find("q6 [rad],dq1"), std::string::npos) << head;
  EXPECT_EQ(std::ranges::count(head, ','), 18);
  const std::string yaml = RobotFile(timed, RobotFormat::kMoveIt, names);
  const Value trajectory = ParseYaml(yaml, "trajectory.yaml").At("joint_trajectory");
  EXPECT_EQ(trajectory.At("joint_names").size(), 6U);
  EXPECT_EQ(trajectory.At("points").elements().front().At("positions").size(), 6U);
}

}  // namespace
}  // namespace calibrato
