#include "calibrato/learning/plan_by_method.h"

#include <gtest/gtest.h>

#include <variant>

#include "calibrato/base/input_error.h"
#include "calibrato/mdp/design_setting.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

MotionDesignProblem SmallProblem() {
  MotionDesignProblem problem;
  problem.task = Task::kExtrinsic;
  problem.rigs = {PaperRig()};
  problem.num_loops = 2;
  problem.max_path_m = 2.0;
  problem.max_duration_s = 10.0;
  problem.frames_per_loop = 16;
  return problem;
}

class PlanByEveryMethod : public testing::TestWithParam<std::string> {};

// Every method beats the average random motion, stays within path, time and carrier, and is
// reproducible.
TEST_P(PlanByEveryMethod, FindsSomethingBetterThanChance) {
  const MotionDesignProblem problem = SmallProblem();
  constexpr int kNumEvaluations = 300;
  const auto design = PlanByMethod(GetParam(), problem, kNumEvaluations, Rng(4));
  ASSERT_TRUE(design.has_value());
  EXPECT_LE(design->num_information_evaluations, kNumEvaluations);
  EXPECT_GE(design->num_information_evaluations, kNumEvaluations / 2);
  EXPECT_EQ(design->loss, ExpectLoss(problem, design->motion).value);
  double random = 0.0;
  constexpr int kNumRandom = 20;
  for (int i = 0; i < kNumRandom; ++i) {
    Rng draw = Rng(9).Stream("motion", static_cast<uint64_t>(i));
    Motion motion = RandomMotion(Task::kExtrinsic, draw);
    motion.loops.resize(2);
    random += ExpectLoss(problem, *FitToBudget(problem, motion)).value / kNumRandom;
  }
  EXPECT_LT(design->loss, random - 0.1);
  EXPECT_LE(PathLength(design->motion), 2.001);
  const auto planned = PlanMotion(design->motion, PaperRig());
  ASSERT_TRUE(std::holds_alternative<TimedMotion>(planned));
  EXPECT_LE(std::get<TimedMotion>(planned).duration_s(), 10.001);
}

INSTANTIATE_TEST_SUITE_P(Methods, PlanByEveryMethod, testing::ValuesIn(PlanMethodNames()),
                         [](const auto& each) {
                           std::string name = each.param;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

// Whatever the number of rigs and parameters, a budget is one.
TEST_P(PlanByEveryMethod, KeepsToItsBudgetOfBothTasksAndSeveralRigs) {
  MotionDesignProblem problem = SmallProblem();
  problem.task = Task::kJoint;
  problem.rigs = BelievedRigs(RigDistribution::kPaper, 1, Rng(3));
  EXPECT_EQ(NumEvaluations(problem), 4);
  constexpr int kNumEvaluations = 600;
  const auto design = PlanByMethod(GetParam(), problem, kNumEvaluations, Rng(4));
  ASSERT_TRUE(design.has_value());
  EXPECT_LE(design->num_information_evaluations, kNumEvaluations);
  EXPECT_GE(design->num_information_evaluations, kNumEvaluations / 4);
}

TEST(PlanByMethod, IsReproducible) {
  for (const char* method : {"fisher", "icem"}) {
    const auto first = PlanByMethod(method, SmallProblem(), 60, Rng(4));
    const auto second = PlanByMethod(method, SmallProblem(), 60, Rng(4));
    EXPECT_EQ(first->loss, second->loss) << method;
    EXPECT_EQ(first->motion.loops[1].coefficients, second->motion.loops[1].coefficients) << method;
  }
}

TEST(PlanByMethod, RefusesWhatItCannot) {
  EXPECT_THROW((void)PlanByMethod("sac", SmallProblem(), 10, Rng(1)), InputError);
  EXPECT_THROW((void)PlanByMethod("gradient", SmallProblem(), 10, Rng(1)), InputError);
}

}  // namespace
}  // namespace calibrato
