#include "calibrato/mdp/extrinsic_environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "calibrato/geometry/rpy.h"
#include "calibrato/mdp/motion_information.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

LoopCoefficients RandomAction(Rng& rng) {
  LoopCoefficients action;
  for (double& a : action) a = rng.Uniform(-0.02, 0.02);
  return action;
}

double Term(const StepResult& step, const std::string& name) {
  for (const auto& [term, value] : step.terms) {
    if (term == name) return value;
  }
  ADD_FAILURE() << "no term " << name;
  return 0.0;
}

TEST(ExtrinsicEnvironment, BeginsWithThePrior) {
  ExtrinsicTask task;
  task.fixed_rig = PaperRig();
  task.fixed_rig->T_c0_i = PriorMeanExtrinsics();
  task.fixed_rig->T_c0_i.t.x() += 0.03;
  ExtrinsicEnvironment environment(task);
  const Eigen::VectorXd y = environment.Reset(Rng(1));
  ASSERT_EQ(y.size(), environment.observation_size());
  EXPECT_LT(y.head<6>().norm(), 1e-12);
  // Three sigmas of 10 mm, then three of 100 mrad, in mm and mrad.
  EXPECT_NEAR(y(6), std::log(10.0), 1e-12);
  EXPECT_NEAR(y(11), std::log(100.0), 1e-12);
  // 0.03 over ||(0.09, 0, -0.1, 0, 0, 1.5708)||.
  EXPECT_NEAR(environment.relative_error(), 0.03 / 1.57654, 1e-5);
}

TEST(InformationStatus, IsInNatsPerParameter) {
  const auto prior = PriorExtrinsicsCovariance();
  EXPECT_NEAR(InformationStatus(DesignCriterion::kA, prior), -0.5 * std::log(30300.0), 1e-9);
  EXPECT_NEAR(InformationStatus(DesignCriterion::kD, prior),
              -0.5 * (std::log(100.0) + std::log(10.0)), 1e-9);
  EXPECT_NEAR(InformationStatus(DesignCriterion::kE, prior), -std::log(100.0), 1e-9);
  // Half the sigma is worth log 2, whatever the criterion.
  for (const auto criterion : {DesignCriterion::kA, DesignCriterion::kD, DesignCriterion::kE}) {
    EXPECT_NEAR(InformationStatus(criterion, 0.25 * prior) - InformationStatus(criterion, prior),
                std::log(2.0), 1e-9);
  }
}

TEST(RelativeExtrinsicError, TakesAnglesTheShortWayRound) {
  const Rigid3 truth{RotationFromRpy({0.0, 0.0, 3.14}), {0.1, 0.0, 0.0}};
  const Rigid3 estimate{RotationFromRpy({0.0, 0.0, -3.14}), {0.1, 0.0, 0.0}};
  EXPECT_NEAR(RelativeExtrinsicError(estimate, truth), (2.0 * M_PI - 6.28) / std::hypot(3.14, 0.1),
              1e-9);
}

TEST(ExtrinsicEnvironment, TheRewardIsTheSumOfItsTermsAndTheyAreTheirIncrements) {
  ExtrinsicEnvironment environment({});
  Rng rng(2);
  (void)environment.Reset(rng.Stream("episode"));
  double information = InformationStatus(DesignCriterion::kA, PriorExtrinsicsCovariance());
  double entropy = 0.0;
  for (int step = 0; step < environment.horizon(); ++step) {
    const double error = environment.relative_error();
    const LoopCoefficients action = RandomAction(rng);
    const StepResult result = environment.Step(action);
    double sum = 0.0;
    for (const auto& [name, value] : result.terms) sum += value;
    EXPECT_NEAR(result.reward, sum, 1e-12);
    EXPECT_NEAR(Term(result, "relative_error"), error - environment.relative_error(), 1e-12);
    EXPECT_NEAR(Term(result, "path_length"), -PathLength(ScaledAction(action)), 1e-12);
    EXPECT_GE(Term(result, "information"), 0.0);
    EXPECT_EQ(Term(result, "reprojection"), 0.0);
    information += Term(result, "information");
    entropy += Term(result, "imu_entropy");
    // The trace is the sum of the eigenvalues that are observed.
    const double trace = (2.0 * result.observation.tail<6>().array()).exp().sum();
    EXPECT_NEAR(information, -0.5 * std::log(trace), 1e-9);
  }
  // Below a millimetre and a milliradian, or near it, and spread over many bins.
  EXPECT_GT(information, -1.0);
  EXPECT_GT(entropy, 6.0);
  EXPECT_LT(entropy, 6.0 * std::log(64.0));
  EXPECT_LT(environment.relative_error(), 0.01);
}

// The covariance that is observed is that which planners expect without executing.
TEST(ExtrinsicEnvironment, KnowsWhatWasExpected) {
  ExtrinsicTask task;
  task.fixed_rig = PaperRig();
  ExtrinsicEnvironment environment(task);
  (void)environment.Reset(Rng(3));
  const LoopCoefficients scale = ScaledAction(LoopCoefficients::Ones());
  const Motion handcrafted = HandcraftedMotion(Task::kExtrinsic);
  Eigen::VectorXd observation;
  for (const Loop& loop : handcrafted.loops) {
    observation = environment.Step(loop.coefficients.cwiseQuotient(scale)).observation;
  }
  const double observed = std::sqrt((2.0 * observation.tail<6>().array()).exp().sum());
  const auto expected = ExpectExtrinsicInformation(PaperRig(), handcrafted);
  EXPECT_NEAR(observed, std::sqrt(expected->criterion), 0.1 * observed);
}

// Lenses, boards, mounts and IMUs of all kinds, with time offsets: a loop or two at random, and
// T_cam_imu is far better known than before any data.
TEST(ExtrinsicEnvironment, CalibratesRigsOfAllKinds) {
  ExtrinsicTask task;
  task.rigs = RigDistribution::kBroad;
  ExtrinsicEnvironment environment(task);
  int num_better = 0;
  for (uint64_t episode = 0; episode < 4; ++episode) {
    (void)environment.Reset(Rng(episode));
    const double before = environment.relative_error();
    Rng actions = Rng(episode).Stream("actions");
    for (int step = 0; step < 2; ++step) (void)environment.Step(RandomAction(actions));
    num_better += environment.relative_error() < 0.2 * before ? 1 : 0;
  }
  EXPECT_GE(num_better, 3);
}

TEST(ExtrinsicEnvironment, ARefusedActionLeavesTheStateAndCosts) {
  ExtrinsicEnvironment environment({});
  Rng rng(4);
  const Eigen::VectorXd before = environment.Reset(rng.Stream("episode"));
  LoopCoefficients too_far = LoopCoefficients::Zero();
  too_far(1) = 0.5;
  const StepResult refused = environment.Step(too_far);
  EXPECT_FALSE(refused.executed);
  EXPECT_EQ(refused.reward, -1.0);
  EXPECT_EQ(refused.observation, before);
}

TEST(ExtrinsicEnvironment, TheFirstStageHasEmpiricalAndPathTermsAlone) {
  ExtrinsicTask task;
  task.calibrate = false;
  ExtrinsicEnvironment environment(task);
  Rng rng(5);
  const Eigen::VectorXd before = environment.Reset(rng.Stream("episode"));
  const StepResult step = environment.Step(RandomAction(rng));
  EXPECT_EQ(step.observation, before);
  EXPECT_EQ(Term(step, "information"), 0.0);
  EXPECT_EQ(Term(step, "relative_error"), 0.0);
  EXPECT_GT(Term(step, "imu_entropy"), 0.0);
  EXPECT_EQ(Term(step, "boards_per_frame"), 1.0);
}

TEST(ExtrinsicEnvironment, IsTheSameForTheSameStream) {
  ExtrinsicEnvironment a({});
  ExtrinsicEnvironment b({});
  Rng actions(6);
  (void)a.Reset(Rng(7));
  (void)b.Reset(Rng(8));
  (void)b.Reset(Rng(7));
  const LoopCoefficients action = RandomAction(actions);
  EXPECT_EQ(a.Step(action).observation, b.Step(action).observation);
}

}  // namespace
}  // namespace calibrato
