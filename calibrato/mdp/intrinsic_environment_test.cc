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

// Tag 5 has a corner 7 px inside: its corners are left out, tags 2 and 7 stay. Alone, it leaves
// nothing that counts.
TEST(FramesThatCount, OfAnAprilGridTheTagsThatAreInside) {
  const Board board = AprilGrid{6, 6, 0.088, 0.3};
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  const auto view_of = [&](const std::vector<int>& tags) {
    BoardView view;
    for (const int tag : tags) {
      for (int corner = 0; corner < 4; ++corner) view.corner_ids.push_back(4 * tag + corner);
    }
    view.points_g = points_g(Eigen::all, view.corner_ids);
    view.pixels = Eigen::Matrix2Xd::Constant(2, view.points_g.cols(), 100.0);
    for (size_t k = 0; k < view.corner_ids.size(); ++k) {
      view.pixels(1, static_cast<Eigen::Index>(k)) += view.corner_ids[k];
      if (view.corner_ids[k] == 4 * 5 + 2) view.pixels(0, static_cast<Eigen::Index>(k)) = 7.0;
    }
    return view;
  };
  const std::vector<BoardView> counted =
      FramesThatCount({view_of({2, 5, 7}), view_of({5}), view_of({3})}, {640, 480}, board);
  ASSERT_EQ(counted.size(), 2u);
  EXPECT_EQ(counted[0].corner_ids, std::vector<int>({8, 9, 10, 11, 28, 29, 30, 31}));
  ASSERT_EQ(counted[0].pixels.cols(), 8);
  EXPECT_EQ(counted[0].pixels(1, 4), 128.0);
  EXPECT_EQ(counted[0].points_g, view_of({2, 7}).points_g);
  EXPECT_EQ(counted[1].corner_ids, std::vector<int>({12, 13, 14, 15}));
}

TEST(IntrinsicTaskModel, IsThatOfOpenCvButForFisheyes) {
  EXPECT_EQ(IntrinsicTaskModel(PaperRig().cameras[0].model), "pinhole-radtan5");
  EXPECT_EQ(
      IntrinsicTaskModel(CameraModel("pinhole-equi", Eigen::VectorXd::LinSpaced(8, 300, 301))),
      "pinhole-equi");
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

}  // namespace
}  // namespace calibrato
