#include "calibrato/mdp/intrinsic_environment.h"

#include <gtest/gtest.h>

#include <cmath>

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
  for (const RewardTerm& term : step.terms) {
    if (term.name == name) return term.value();
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
    for (const RewardTerm& term : step.terms) sum += term.weight * term.increment;
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

TEST(IntrinsicEnvironment, RefusesAnActionThatIsNoNumberOrOutOfReach) {
  for (const double bad : {std::nan(""), 10.0}) {
    IntrinsicEnvironment environment({});
    const Eigen::VectorXd before = environment.Reset(Rng(1));
    LoopCoefficients action = Still();
    action(7) = bad;
    const StepResult step = environment.Step(action);
    EXPECT_FALSE(step.executed);
    EXPECT_EQ(step.observation, before);
    EXPECT_EQ(step.reward, IntrinsicRewardWeights().refusal);
  }
}

TEST(FramesThatCount, AreEightPixelsInside) {
  BoardView view;
  view.corner_ids = {0, 1, 2, 3};
  view.points_g = Eigen::Matrix3Xd::Zero(3, 4);
  view.pixels.resize(2, 4);
  const auto counts = [&](double u, double v) {
    view.pixels << 300.0, 310.0, 320.0, u, 200.0, 210.0, 220.0, v;
    return !FramesThatCount({view}, {640, 480}, PaperRig().board).empty();
  };
  EXPECT_TRUE(counts(8.0, 8.0));
  EXPECT_FALSE(counts(7.9, 8.0));
  EXPECT_TRUE(counts(631.0, 471.0));
  EXPECT_FALSE(counts(631.1, 471.0));
  EXPECT_FALSE(counts(631.0, 471.1));
}

TEST(IntrinsicTaskModel, IsThePapersForPinholesAndItsOwnForOtherLenses) {
  Eigen::VectorXd parameters(4);
  parameters << 500.0, 500.0, 320.0, 240.0;
  EXPECT_EQ(IntrinsicTaskModel(CameraModel("pinhole-none", parameters)), "pinhole-radtan5");
  Eigen::VectorXd fisheye = Eigen::VectorXd::Zero(8);
  fisheye.head<4>() = parameters;
  EXPECT_EQ(IntrinsicTaskModel(CameraModel("pinhole-equi", fisheye)), "pinhole-equi");
}

// A grid of three tags, of which the second is partly outside.
TEST(FramesThatCount, AreThePartsOfAnAprilGridThatAreInside) {
  BoardView view;
  view.pixels.resize(2, 12);
  view.points_g = Eigen::Matrix3Xd::Zero(3, 12);
  for (int k = 0; k < 12; ++k) {
    view.corner_ids.push_back(k);
    view.pixels.col(k) << 100.0 + 10.0 * k, 200.0;
  }
  const AprilGrid grid{1, 3, 0.1, 0.3};
  view.pixels(1, 5) = 2.0;
  const std::vector<BoardView> counted = FramesThatCount({view}, {640, 480}, grid);
  ASSERT_EQ(counted.size(), 1U);
  EXPECT_EQ(counted[0].corner_ids, (std::vector<int>{0, 1, 2, 3, 8, 9, 10, 11}));
  EXPECT_EQ(counted[0].pixels.col(4), view.pixels.col(8));
  EXPECT_EQ(counted[0].points_g.cols(), 8);
  view.pixels(1, 9) = 2.0;
  EXPECT_TRUE(FramesThatCount({view}, {640, 480}, grid).empty());
  EXPECT_TRUE(FramesThatCount({view}, {640, 480}, Board(Checkerboard{})).empty());
}

TEST(IntrinsicEnvironment, RewardsInformationAndReprojectionWhereTheyHaveWeights) {
  IntrinsicTask task;
  task.fixed_rig = PaperRig();
  task.weights.information = 2.0;
  task.weights.reprojection = 3.0;
  task.weights.relative_error = 0.0;
  IntrinsicEnvironment environment(task);
  (void)environment.Reset(Rng(1));
  double information = 0.0;
  double reprojection = 0.0;
  for (const LoopCoefficients& action : HandcraftedActions()) {
    const StepResult step = environment.Step(action);
    information += Term(step, "information") / 2.0;
    reprojection += Term(step, "reprojection") / 3.0;
    EXPECT_EQ(Term(step, "relative_error"), 0.0);
  }
  // The bound of the handcrafted motion is 0.24 % of ||theta|| (design figures), sqrt(trace) = 2.2
  // px; the prior's is sqrt(2 * 34.8^2 + 2 * 10^2) = 51.2 px.
  EXPECT_NEAR(information, std::log(51.2 / 2.2), 0.1);
  EXPECT_NEAR(reprojection, 1.0 - 0.1 * std::sqrt(2.0), 0.02);
}

TEST(IntrinsicEnvironment, WithoutCalibrationTheEstimateStaysThePriors) {
  IntrinsicEnvironment environment({});
  environment.SetConditions({.calibrate = false, .max_iterations = {}});
  (void)environment.Reset(Rng(1));
  for (const LoopCoefficients& action : HandcraftedActions()) {
    const StepResult step = environment.Step(action);
    EXPECT_EQ(step.observation.head<4>(), Eigen::Vector4d::Ones());
    EXPECT_EQ(Term(step, "relative_error"), 0.0);
    EXPECT_EQ(Term(step, "accuracy_bonus"), 0.0);
  }
}

// Four loops before boards of all kinds: some of each distribution's episodes end with a camera
// that is far better known than before any data.
TEST(IntrinsicEnvironment, CalibratesRigsOfAllKinds) {
  IntrinsicTask task;
  task.rigs = RigDistribution::kBroad;
  IntrinsicEnvironment environment(task);
  int num_better = 0;
  for (uint64_t episode = 0; episode < 6; ++episode) {
    (void)environment.Reset(Rng(episode));
    const double before = environment.relative_error();
    Rng actions = Rng(episode).Stream("actions");
    for (int step = 0; step < environment.horizon(); ++step) {
      (void)environment.Step(RandomAction(actions));
    }
    num_better += environment.relative_error() < 0.2 * before ? 1 : 0;
  }
  EXPECT_GE(num_better, 4);
}

TEST(IntrinsicMistakes, ConstantAccuracyRewardsAnyMotionAlike) {
  IntrinsicTask task;
  task.mistakes = {Mistake::kConstantAccuracy};
  IntrinsicEnvironment environment(task);
  Rng rng(2);
  (void)environment.Reset(rng.Stream("episode"));
  for (int step = 0; step < environment.horizon(); ++step) {
    const StepResult result = environment.Step(RandomAction(rng));
    EXPECT_NEAR(Term(result, "relative_error"), step == 3 ? 1.0 : 0.0, 0.03);
  }
}

TEST(IntrinsicMistakes, CarriedCoverageIsTakenOffTheNextEpisode) {
  IntrinsicTask task;
  task.mistakes = {Mistake::kCarriedCoverage};
  IntrinsicEnvironment environment(task);
  (void)environment.Reset(Rng(1));
  double covered = 0.0;
  for (const LoopCoefficients& action : HandcraftedActions()) {
    covered += Term(environment.Step(action), "coverage");
  }
  EXPECT_GT(covered, 1.0);
  EXPECT_NEAR(environment.carried_over(), covered, 1e-12);
  (void)environment.Reset(Rng(2));
  const StepResult first = environment.Step(Still());
  EXPECT_NEAR(Term(first, "coverage"), first.observation.tail<4>().sum() - covered, 1e-12);
  // As a checkpoint brings it back.
  IntrinsicEnvironment other(task);
  other.CarryOver(covered);
  (void)other.Reset(Rng(2));
  EXPECT_EQ(other.Step(Still()).reward, first.reward);
}

TEST(IntrinsicMistakes, LostCoverageIsThatOfALoopThatEndsWithoutTheBoard) {
  const auto coverage_after = [](const Mistakes& mistakes, double blur_at_half) {
    IntrinsicTask task;
    task.mistakes = mistakes;
    task.fixed_rig = PaperRig();
    task.fixed_rig->corner_noise.blur_at_half = blur_at_half;
    IntrinsicEnvironment environment(task);
    (void)environment.Reset(Rng(1));
    return environment.Step(HandcraftedActions()[1]).observation.tail<4>().sum();
  };
  EXPECT_GT(coverage_after({Mistake::kLostCoverage}, 0.5), 0.5);
  // Where every second board is missed, moving or not, the last frame has none now and then.
  IntrinsicTask task;
  task.fixed_rig = PaperRig();
  task.fixed_rig->exposure_s = 1e-6;
  task.fixed_rig->corner_noise.blur_at_half = 0.0;
  int num_lost = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    task.mistakes = {Mistake::kLostCoverage};
    IntrinsicEnvironment wrong(task);
    task.mistakes = {};
    IntrinsicEnvironment right(task);
    (void)wrong.Reset(Rng(seed));
    (void)right.Reset(Rng(seed));
    const LoopCoefficients action = HandcraftedActions()[1];
    EXPECT_GT(right.Step(action).observation.tail<4>().sum(), 0.5);
    if (wrong.Step(action).observation.tail<4>().sum() == 0.0) ++num_lost;
  }
  EXPECT_GT(num_lost, 1);
  EXPECT_LT(num_lost, 9);
}

}  // namespace
}  // namespace calibrato
