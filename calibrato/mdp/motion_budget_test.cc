#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "calibrato/mdp/design_problem.h"
#include "calibrato/motion/loop_demands.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

MotionDesignProblem IntrinsicProblem() {
  MotionDesignProblem problem;
  problem.task = Task::kIntrinsic;
  problem.rigs = {PaperRig()};
  problem.num_loops = NumLoops(Task::kIntrinsic);
  return problem;
}

Motion SomeMotion(uint64_t seed) {
  Rng rng(seed);
  return RandomMotion(Task::kIntrinsic, rng);
}

double Duration(const Motion& motion) {
  double sum = 0.0;
  for (const Loop& loop : motion.loops) sum += loop.duration_s;
  return sum;
}

// The factor between two motions of the same shape; fails where they are not.
double FactorBetween(const Motion& whole, const Motion& scaled) {
  const double factor = scaled.loops[0].coefficients.norm() / whole.loops[0].coefficients.norm();
  for (size_t i = 0; i < whole.loops.size(); ++i) {
    EXPECT_LT((scaled.loops[i].coefficients - factor * whole.loops[i].coefficients).norm(), 1e-12);
  }
  return factor;
}

TEST(FitToBudget, ShrinksToThePathAndUsesTheTime) {
  MotionDesignProblem problem = IntrinsicProblem();
  problem.max_path_m = 3.0;
  problem.max_duration_s = 22.0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Motion whole = SomeMotion(seed);
    const std::optional<Motion> fitted = FitToBudget(problem, whole);
    ASSERT_TRUE(fitted.has_value());
    EXPECT_LT(FactorBetween(whole, *fitted), 0.5);
    EXPECT_NEAR(PathLength(*fitted), 3.0, 1e-2);
    EXPECT_NEAR(Duration(*fitted), 22.0, 1e-9);
    // The carrier, which judges by other code, needs no more time.
    const auto planned = PlanMotion(*fitted, PaperRig());
    ASSERT_TRUE(std::holds_alternative<TimedMotion>(planned));
    EXPECT_NEAR(std::get<TimedMotion>(planned).duration_s(), 22.0, 1e-6);
  }
}

TEST(FitToBudget, ShrinksToTheTimeAndTheReach) {
  MotionDesignProblem problem = IntrinsicProblem();
  problem.max_duration_s = 6.0;
  Motion whole = SomeMotion(3);
  for (Loop& loop : whole.loops) loop.coefficients *= 4.0;
  const std::optional<Motion> hurried = FitToBudget(problem, whole);
  ASSERT_TRUE(hurried.has_value());
  const auto planned = PlanMotion(*hurried, PaperRig());
  ASSERT_TRUE(std::holds_alternative<TimedMotion>(planned));
  EXPECT_NEAR(std::get<TimedMotion>(planned).duration_s(), 6.0, 1e-6);

  problem.max_duration_s = 1e9;
  problem.limits.reach = 0.55;
  const std::optional<Motion> close = FitToBudget(problem, whole);
  ASSERT_TRUE(close.has_value());
  double furthest = 0.0;
  for (const Loop& loop : close->loops) {
    const LoopDemands demands = DemandsOf(problem.base_pose, loop, PaperRig(), problem.limits);
    furthest = std::max(furthest, demands.reach.largest);
  }
  EXPECT_LE(furthest, 1.0);
  EXPECT_GT(furthest, 0.9);
}

TEST(FitToBudget, LeavesAloneWhatFits) {
  const Motion whole = SomeMotion(2);
  const std::optional<Motion> fitted = FitToBudget(IntrinsicProblem(), whole);
  ASSERT_TRUE(fitted.has_value());
  for (size_t i = 0; i < whole.loops.size(); ++i) {
    EXPECT_EQ(fitted->loops[i].coefficients, whole.loops[i].coefficients);
    EXPECT_GE(fitted->loops[i].duration_s, whole.loops[i].duration_s);
  }
}

TEST(FitToBudget, ChargesTheLoopsThatWereExecuted) {
  MotionDesignProblem problem = IntrinsicProblem();
  problem.num_fixed_loops = 2;
  const Motion whole = SomeMotion(4);
  const double executed =
      PathLength(whole.loops[0].coefficients) + PathLength(whole.loops[1].coefficients);
  problem.max_path_m = executed + 0.5;
  const std::optional<Motion> fitted = FitToBudget(problem, whole);
  ASSERT_TRUE(fitted.has_value());
  EXPECT_EQ(fitted->loops[1].coefficients, whole.loops[1].coefficients);
  EXPECT_NEAR(PathLength(*fitted), executed + 0.5, 1e-3);
  problem.max_path_m = executed - 0.1;
  EXPECT_FALSE(FitToBudget(problem, whole).has_value());
}

}  // namespace
}  // namespace calibrato
