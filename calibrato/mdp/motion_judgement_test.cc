#include "calibrato/mdp/motion_judgement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <variant>

#include "calibrato/mdp/design_problem.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {
namespace {

TimedMotion Handcrafted(Task task) {
  return std::get<TimedMotion>(PlanMotion(HandcraftedMotion(task), PaperRig()));
}

class JudgeMotionOf : public testing::TestWithParam<Task> {};

// What is expected before any data and what the solver states after them are two ways to the same
// number: the noise it finds differs by a few per cent.
TEST_P(JudgeMotionOf, StatesWhatWasExpected) {
  const Task task = GetParam();
  Rng draw(7);
  const Rig rig = DrawRig(RigDistribution::kPaper, draw);
  const TimedMotion motion = Handcrafted(task);
  MotionDesignProblem problem;
  problem.task = task;
  problem.rigs = {rig};
  problem.num_loops = NumLoops(task);
  Motion executed = motion.motion;
  for (size_t i = 0; i < executed.loops.size(); ++i) {
    executed.loops[i].duration_s = motion.loop_duration_s[i];
  }
  const double expected = ExpectLoss(problem, executed).value;
  const MotionJudgement judgement =
      JudgeMotion(task, rig, motion, Fidelity::kFast, DesignCriterion::kA, Rng(1));
  EXPECT_NEAR(judgement.stated_loss, expected, 0.12);
  EXPECT_EQ(judgement.nees_dimension, task == Task::kIntrinsic ? 4 : 6);
  // Chi-square of 6: above 24 once in two thousand.
  EXPECT_LT(judgement.nees, 24.0);
  EXPECT_LT(judgement.relative_error, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Tasks, JudgeMotionOf, testing::Values(Task::kIntrinsic, Task::kExtrinsic),
                         [](const auto& each) { return TaskName(each.param); });

TEST(JudgeMotion, OfNothingLearnedIsThePrior) {
  TimedMotion still = Handcrafted(Task::kIntrinsic);
  for (Loop& loop : still.motion.loops) loop.coefficients.setZero();
  const MotionJudgement judgement = JudgeMotion(Task::kIntrinsic, PaperRig(), still,
                                                Fidelity::kFast, DesignCriterion::kA, Rng(1));
  // 34.8 px for fu and fv, 10 px for pu and pv.
  EXPECT_NEAR(judgement.stated_loss, 0.5 * std::log(2.0 * 34.8 * 34.8 + 2.0 * 100.0), 0.01);
}

TEST(JudgeMotion, IsReproducible) {
  const TimedMotion motion = Handcrafted(Task::kJoint);
  const auto judge = [&] {
    return JudgeMotion(Task::kJoint, PaperRig(), motion, Fidelity::kFast, DesignCriterion::kA,
                       Rng(3));
  };
  const MotionJudgement first = judge();
  EXPECT_EQ(first.nees_dimension, 10);
  EXPECT_EQ(first.stated_loss, judge().stated_loss);
  EXPECT_EQ(first.nees, judge().nees);
}

}  // namespace
}  // namespace calibrato
