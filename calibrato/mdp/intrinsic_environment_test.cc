#include "calibrato/mdp/intrinsic_environment.h"

#include <gtest/gtest.h>

#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

LoopCoefficients Still() { return LoopCoefficients::Zero(); }

LoopCoefficients RandomAction(Rng& rng) {
  LoopCoefficients action;
  for (double& a : action) a = rng.Uniform(-0.02, 0.02);
  return action;
}

// The actions, before scaling, of the handcrafted motion.
std::vector<LoopCoefficients> HandcraftedActions() {
  const LoopCoefficients scale = ScaledAction(LoopCoefficients::Ones());
  std::vector<LoopCoefficients> actions;
  for (const Loop& loop : HandcraftedMotion(Task::kIntrinsic).loops) {
    actions.emplace_back(loop.coefficients.cwiseQuotient(scale));
  }
  return actions;
}

double Term(const StepResult& step, const std::string& name) {
  for (const auto& [term, value] : step.terms) {
    if (term == name) return value;
  }
  ADD_FAILURE() << "no term " << name;
  return 0.0;
}

TEST(IntrinsicEnvironment, BeginsWithThePriorAndNoCoverage) {
  IntrinsicEnvironment environment({});
  const Eigen::VectorXd y = environment.Reset(Rng(1));
  ASSERT_EQ(y.size(), environment.observation_size());
  EXPECT_EQ(y.head<4>(), Eigen::Vector4d::Ones());
  EXPECT_EQ(y.tail<4>(), Eigen::Vector4d::Zero());
}

TEST(IntrinsicEnvironment, TheErrorBeforeAnyDataIsThatOfThePriorMean) {
  IntrinsicTask task;
  task.fixed_rig = PaperRig();
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(9);
  parameters.head<4>() << 600.0, 600.0, 320.5, 240.5;
  task.fixed_rig->cameras[0].model = CameraModel("pinhole-radtan5", parameters);
  IntrinsicEnvironment environment(task);
  (void)environment.Reset(Rng(1));
  // sqrt(2) * (600 - 585.7561) over sqrt(2 * 600^2 + 320.5^2 + 240.5^2).
  EXPECT_NEAR(environment.relative_error(), 1.41421356 * 14.2439 / 938.2, 1e-4);
}

// The first view of the scene covers 0.60 of the size range, and nothing else. By hand: corners
// over 0.30 m x 0.36 m at 1.442 m and f = 585.76 px have s = 133.5 px, 0.241 of sqrt(640 * 480).
TEST(IntrinsicEnvironment, TheInitialViewCoversSizeAlone) {
  IntrinsicTask task;
  task.fixed_rig = PaperRig();
  task.fixed_rig->corner_noise.stddev_px = 0.0;
  IntrinsicEnvironment environment(task);
  (void)environment.Reset(Rng(1));
  const StepResult step = environment.Step(Still());
  EXPECT_NEAR(step.observation(6), 0.60, 0.01);
  EXPECT_NEAR(step.observation(4), 0.0, 1e-9);
  EXPECT_NEAR(step.observation(5), 0.0, 1e-9);
  // One and the same view for five seconds determines no camera: the prior stands.
  const Eigen::Vector4d estimate = step.observation.head<4>();
  EXPECT_EQ(estimate, Eigen::Vector4d::Ones());
}

TEST(IntrinsicEnvironment, TheRewardIsTheSumOfItsTermsAndTheyAreTheirIncrements) {
  IntrinsicEnvironment environment({});
  Rng rng(2);
  Eigen::VectorXd before = environment.Reset(rng.Stream("episode"));
  double error = environment.relative_error();
  double bonus = 0.0;
  for (const LoopCoefficients& action : HandcraftedActions()) {
    const StepResult step = environment.Step(action);
    double sum = 0.0;
    for (const auto& [name, value] : step.terms) sum += value;
    EXPECT_NEAR(step.reward, sum, 1e-14);
    EXPECT_NEAR(Term(step, "coverage"), step.observation.tail<4>().sum() - before.tail<4>().sum(),
                1e-12);
    EXPECT_NEAR(Term(step, "relative_error"), error - environment.relative_error(), 1e-12);
    EXPECT_NEAR(Term(step, "path_length"), -0.2 * PathLength(ScaledAction(action)), 1e-12);
    bonus += Term(step, "accuracy_bonus");
    before = step.observation;
    error = environment.relative_error();
  }
  EXPECT_LT(error, 0.01);
  EXPECT_EQ(bonus, 5.0);  // Paid once.
}

TEST(IntrinsicEnvironment, ARefusedActionLeavesTheStateAndCosts) {
  IntrinsicEnvironment environment({});
  Rng rng(3);
  (void)environment.Reset(rng.Stream("episode"));
  const StepResult first = environment.Step(RandomAction(rng));
  const double error = environment.relative_error();
  LoopCoefficients too_far = LoopCoefficients::Zero();
  too_far(1) = 0.5;  // Half a metre to the front.
  const StepResult refused = environment.Step(too_far);
  EXPECT_FALSE(refused.executed);
  EXPECT_EQ(refused.reward, -1.0);
  EXPECT_EQ(refused.observation, first.observation);
  EXPECT_EQ(environment.relative_error(), error);
}

TEST(IntrinsicEnvironment, IsTheSameForTheSameStream) {
  IntrinsicEnvironment a({});
  IntrinsicEnvironment b({});
  Rng actions(4);
  (void)a.Reset(Rng(5));
  (void)b.Reset(Rng(5));
  const LoopCoefficients action = RandomAction(actions);
  EXPECT_EQ(a.Step(action).observation, b.Step(action).observation);
  // A second episode does not depend on the first.
  (void)a.Reset(Rng(6));
  (void)b.Reset(Rng(7));
  (void)b.Reset(Rng(6));
  EXPECT_EQ(a.Step(action).observation, b.Step(action).observation);
}

TEST(FramesThatCount, AreEightPixelsInside) {
  BoardView view;
  view.pixels.resize(2, 2);
  const auto counts = [&](double u, double v) {
    view.pixels << 300.0, u, 200.0, v;
    return !FramesThatCount({view}, {640, 480}).empty();
  };
  EXPECT_TRUE(counts(8.0, 8.0));
  EXPECT_FALSE(counts(7.9, 8.0));
  EXPECT_TRUE(counts(631.0, 471.0));
  EXPECT_FALSE(counts(631.1, 471.0));
  EXPECT_FALSE(counts(631.0, 471.1));
}

}  // namespace
}  // namespace calibrato
