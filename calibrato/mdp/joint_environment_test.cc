#include "calibrato/mdp/joint_environment.h"

#include <gtest/gtest.h>

#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

double Term(const StepResult& step, const std::string& name) {
  for (const RewardTerm& term : step.terms) {
    if (term.name == name) return term.value();
  }
  ADD_FAILURE() << "no term " << name;
  return 0.0;
}

std::vector<LoopCoefficients> HandcraftedActions() {
  const LoopCoefficients scale = ScaledAction(LoopCoefficients::Ones());
  std::vector<LoopCoefficients> actions;
  for (const Loop& loop : HandcraftedMotion(Task::kJoint).loops) {
    actions.emplace_back(loop.coefficients.cwiseQuotient(scale));
  }
  return actions;
}

TEST(JointEnvironment, CalibratesBothAfterEachLoop) {
  JointEnvironment environment({});
  const Eigen::VectorXd start = environment.Reset(Rng(1));
  ASSERT_EQ(start.size(), 20);
  EXPECT_EQ(start.head<4>(), Eigen::Vector4d::Ones());
  EXPECT_EQ(start.segment<10>(4), Eigen::VectorXd::Zero(10));
  double sum_of_errors = 2.0 * environment.relative_error();
  Eigen::VectorXd before = start;
  double bonus = 0.0;
  ASSERT_EQ(HandcraftedActions().size(), 4U);
  for (const LoopCoefficients& action : HandcraftedActions()) {
    const StepResult step = environment.Step(action);
    EXPECT_NEAR(step.reward, SumOf(step.terms), 1e-12);
    EXPECT_NEAR(Term(step, "coverage"),
                step.observation.segment<4>(4).sum() - before.segment<4>(4).sum(), 1e-12);
    EXPECT_NEAR(Term(step, "path_length"), -0.6 * PathLength(ScaledAction(action)), 1e-12);
    sum_of_errors -= Term(step, "intrinsic_error") + Term(step, "extrinsic_error");
    EXPECT_NEAR(sum_of_errors, 2.0 * environment.relative_error(), 1e-12);
    bonus += Term(step, "accuracy_bonus");
    before = step.observation;
  }
  EXPECT_EQ(bonus, 5.0);
  EXPECT_NE(before.head<4>(), Eigen::Vector4d::Ones());
  // The worst direction of the extrinsics: from 100 mrad to a few mm or mrad.
  EXPECT_LT(before(19), start(19) - 2.0);
  EXPECT_LT(environment.relative_error(), 0.01);
}

TEST(JointEnvironment, HasNoExtrinsicsWithoutACamera) {
  JointEnvironment environment({});
  const Eigen::VectorXd start = environment.Reset(Rng(1));
  const StepResult step = environment.Step(LoopCoefficients::Zero());
  EXPECT_TRUE(step.executed);
  EXPECT_EQ(step.observation.tail<12>(), start.tail<12>());
  EXPECT_EQ(Term(step, "extrinsic_information"), 0.0);
  EXPECT_EQ(Term(step, "boards_per_frame"), 1.0);
}

TEST(JointEnvironment, ARefusedActionLeavesTheStateAndCosts) {
  JointEnvironment environment({});
  const Eigen::VectorXd start = environment.Reset(Rng(1));
  LoopCoefficients too_far = LoopCoefficients::Zero();
  too_far(1) = 0.5;
  const StepResult refused = environment.Step(too_far);
  EXPECT_FALSE(refused.executed);
  EXPECT_EQ(refused.reward, -1.0);
  EXPECT_EQ(refused.observation, start);
}

TEST(JointEnvironment, IsTheSameForTheSameStreamAndForAClone) {
  JointEnvironment a({});
  (void)a.Reset(Rng(8));
  const std::unique_ptr<Environment> b = a.Clone();
  (void)a.Reset(Rng(7));
  (void)b->Reset(Rng(7));
  const LoopCoefficients action = HandcraftedActions()[1];
  EXPECT_EQ(a.Step(action).observation, b->Step(action).observation);
}

}  // namespace
}  // namespace calibrato
