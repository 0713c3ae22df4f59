#include "calibrato/evaluation/contest.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/input_error.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

ContestSetting Extrinsic(int num_rigs) {
  ContestSetting setting;
  setting.task = Task::kExtrinsic;
  setting.num_rigs = num_rigs;
  return setting;
}

TEST(Contest, ExtrinsicErrorsAreWithinWhatTheCovarianceSays) {
  const ContestSetting setting = Extrinsic(12);
  const std::vector<Rig> rigs = RigsUnderTrial(setting);
  const std::vector<Contestant> contestants = {FixedContestant(
      "handcrafted", HandcraftedMotion(Task::kExtrinsic), Carrier::kFree, PlanningScene(setting))};
  const ContestTrials trials = RunContest(setting, rigs, contestants);
  ASSERT_EQ(trials.size(), 1U);
  ASSERT_EQ(trials[0].size(), 1U);
  ASSERT_EQ(trials[0][0].size(), 12U);
  EXPECT_EQ(NumFailures(trials[0]), 0);
  // Mean of 12 chi-square variables of 6 dimensions: 6 +- 1 (standard deviation).
  const double nees = Mean(Existing(FiguresOf(trials[0], &Trial::nees)));
  EXPECT_GT(nees, 3.0);
  EXPECT_LT(nees, 9.5);
  for (const Trial& trial : trials[0][0]) {
    // About 1.3 mm, 0.8 mrad and 0.05 ms are to be expected; intrinsic figures are not there.
    EXPECT_LT(trial.translation_error_m, 6e-3);
    EXPECT_LT(trial.rotation_error_rad, 4e-3);
    EXPECT_LT(trial.time_offset_error_s, 5e-4);
    EXPECT_GT(trial.prediction_error_px, 0.0);
    EXPECT_TRUE(std::isnan(trial.focal_error_px));
    EXPECT_NEAR(trial.motion_s, 15.0, 1e-9);
    EXPECT_NEAR(trial.path_length_original_m, 3.3062, 1e-4);
  }
}

// The paper states 1.97e-7 for the handcrafted motion and 4.16e-8 for random ones.
TEST(Contest, TheOriginalsQuantityIsOfThePapersSize) {
  const ContestSetting setting = Extrinsic(2);
  const std::vector<Rig> rigs = RigsUnderTrial(setting);
  const ContestTrials trials =
      RunContest(setting, rigs,
                 {FixedContestant("handcrafted", HandcraftedMotion(Task::kExtrinsic),
                                  Carrier::kFree, PlanningScene(setting)),
                  RandomContestant(Task::kExtrinsic, Carrier::kFree, rigs, Rng(1))});
  const double handcrafted = trials[0][0][0].a_optimality_original;
  const double random = trials[1][0][0].a_optimality_original;
  EXPECT_GT(handcrafted, 0.7e-7);
  EXPECT_LT(handcrafted, 4e-7);
  EXPECT_LT(random, handcrafted);
  // The whole block's inverse is another number.
  EXPECT_GT(100.0 * 100.0 * trials[0][0][0].a_optimality_conditional, 10.0 * handcrafted);
}

TEST(Contest, AMotionThatShowsNothingIsAFailureThatSaysWhy) {
  ContestSetting setting = Extrinsic(2);
  Rig blind = PaperRig();
  // As large as a house.
  blind.board = Checkerboard{6, 7, 2.0, 2.0};
  setting.fixed_rig = blind;
  const std::vector<Rig> rigs = RigsUnderTrial(setting);
  const Contestant contestant = FixedContestant("handcrafted", HandcraftedMotion(Task::kExtrinsic),
                                                Carrier::kFree, PaperRig());
  const ContestTrials trials = RunContest(setting, rigs, {contestant});
  EXPECT_EQ(NumFailures(trials[0]), 2);
  EXPECT_EQ(trials[0][0][0].failure, "fewer than three frames show the board");
  EXPECT_TRUE(std::isnan(trials[0][0][0].relative_error));
}

TEST(Contest, PhysicalIsRefusedWithoutAnArm) {
  ContestSetting setting = Extrinsic(2);
  setting.fidelity = Fidelity::kPhysical;
  EXPECT_THROW(static_cast<void>(RunContest(setting, RigsUnderTrial(setting), {})), InputError);
}

TEST(Contest, PhysicalIsRefusedForARecordedTrajectory) {
  ContestSetting setting = Extrinsic(1);
  setting.fidelity = Fidelity::kPhysical;
  setting.carrier = Carrier::kArm;
  RecordedTrajectory hand;
  for (int k = 0; k <= 100; ++k) {
    hand.t_s.push_back(0.02 * k);
    hand.T_g_c0.push_back({Eigen::Matrix3d::Identity(), {0.1 * std::sin(0.1 * k), 0.0, 1.4}});
  }
  const auto brought =
      BroughtContestants({{"hand", hand, {}}}, setting.task, Carrier::kArm, PaperRig());
  try {
    static_cast<void>(RunContest(setting, RigsUnderTrial(setting), brought));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("hand: a recorded trajectory"), std::string::npos)
        << error.what();
  }
}

TEST(Contestants, MotionsOfOneNameAreMembersOfOneMethod) {
  const Motion motion = HandcraftedMotion(Task::kIntrinsic);
  const std::vector<MotionUnderTrial> brought = {{"learned", motion, Task::kIntrinsic},
                                                 {"other", motion, {}},
                                                 {"learned", motion, Task::kIntrinsic},
                                                 {"learned", motion, Task::kExtrinsic}};
  const auto contestants =
      BroughtContestants(brought, Task::kIntrinsic, Carrier::kFree, PaperRig());
  ASSERT_EQ(contestants.size(), 2U);
  EXPECT_EQ(contestants[0].policy, "learned");
  EXPECT_EQ(contestants[0].num_members(), 2U);
  EXPECT_EQ(contestants[1].num_members(), 1U);
}

TEST(Contestants, PoliciesAimAtTheBoardAndWhatSomebodyPlacedStaysThere) {
  Rig scene = PaperRig();
  scene.T_w_g.t.y() += 0.1;
  const Motion motion = HandcraftedMotion(Task::kIntrinsic);
  const auto contestants = BroughtContestants({{"learned", motion, {}, true}, {"file", motion, {}}},
                                              Task::kIntrinsic, Carrier::kFree, scene);
  ASSERT_EQ(contestants.size(), 2U);
  const BasePose& aimed = contestants[0].motions[0].timed->motion.base_pose;
  const BasePose& placed = contestants[1].motions[0].timed->motion.base_pose;
  EXPECT_EQ(placed, motion.base_pose);
  EXPECT_EQ(aimed, BasePoseBeforeBoard(scene));
  EXPECT_FALSE(aimed == placed);
}

TEST(Contest, MotionsArePlannedAnewBeforeBoardsThatStandElsewhere) {
  ContestSetting setting = Extrinsic(2);
  setting.rigs = RigDistribution::kBroad;
  const std::vector<Rig> rigs = RigsUnderTrial(setting);
  const ExecutableMotion planned =
      MakeExecutable(HandcraftedMotion(Task::kExtrinsic), Carrier::kFree, PaperRig());
  const ExecutableMotion moved = MotionOnRig(setting, planned, rigs[0]);
  EXPECT_EQ(moved.timed->motion.base_pose, BasePoseBeforeBoard(rigs[0]));
  setting.rigs = RigDistribution::kPaper;
  EXPECT_EQ(MotionOnRig(setting, planned, PaperRig()).timed->motion.base_pose,
            planned.timed->motion.base_pose);
}

}  // namespace
}  // namespace calibrato
