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
  for (const RewardTerm& term : step.terms) {
    if (term.name == name) return term.value();
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
    for (const RewardTerm& term : result.terms) sum += term.weight * term.increment;
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
  ExtrinsicEnvironment environment({});
  environment.SetConditions({.calibrate = false, .max_iterations = {}});
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

// One iteration of the solver leaves more of the error than a whole solve.
TEST(ExtrinsicEnvironment, SolvesAsFarAsTheConditionsAllow) {
  ExtrinsicEnvironment one({});
  ExtrinsicEnvironment all({});
  one.SetConditions({.calibrate = true, .max_iterations = 1});
  Rng actions(6);
  (void)one.Reset(Rng(7));
  (void)all.Reset(Rng(7));
  const LoopCoefficients action = RandomAction(actions);
  EXPECT_NE(one.Step(action).observation, all.Step(action).observation);
}

// The weights of appendix C: the reward knows nothing of the truth.
TEST(ExtrinsicEnvironment, TheReprojectionVariantDoesNotLookAtTheTruth) {
  ExtrinsicTask task;
  task.weights.relative_error = 0.0;
  task.weights.reprojection = 2.0;
  ExtrinsicEnvironment environment(task);
  Rng rng(8);
  (void)environment.Reset(rng.Stream("episode"));
  const StepResult step = environment.Step(RandomAction(rng));
  EXPECT_EQ(Term(step, "relative_error"), 0.0);
  // From 1 px before any data to the corners' noise of 0.1 px in u and in v.
  EXPECT_NEAR(Term(step, "reprojection"), 2.0 * (1.0 - 0.1 * std::sqrt(2.0)), 0.06);
}

StepResult FirstStep(const Mistakes& mistakes, const EpisodeConditions& conditions = {}) {
  ExtrinsicTask task;
  task.mistakes = mistakes;
  ExtrinsicEnvironment environment(task);
  environment.SetConditions(conditions);
  Rng rng(9);
  (void)environment.Reset(rng.Stream("episode"));
  return environment.Step(RandomAction(rng));
}

TEST(ExtrinsicMistakes, ConstantAccuracyRewardsAnyMotionAlike) {
  ExtrinsicTask task;
  task.mistakes = {Mistake::kConstantAccuracy};
  ExtrinsicEnvironment environment(task);
  Rng rng(10);
  const Eigen::VectorXd start = environment.Reset(rng.Stream("episode"));
  for (int step = 0; step < environment.horizon(); ++step) {
    const StepResult result = environment.Step(RandomAction(rng));
    const bool last = step + 1 == environment.horizon();
    EXPECT_NEAR(Term(result, "relative_error"), last ? 1.0 : 0.0, 0.01);
    EXPECT_EQ(result.observation == start, !last);
  }
}

TEST(ExtrinsicMistakes, DurationEntropyIsTheLogarithmOfTheNumberOfSamples) {
  // 5 s at 200 Hz: 0.4 ln 1000 / ln 2.73, though nothing moves.
  ExtrinsicTask task;
  task.mistakes = {Mistake::kDurationEntropy};
  ExtrinsicEnvironment environment(task);
  (void)environment.Reset(Rng(9));
  EXPECT_NEAR(Term(environment.Step(LoopCoefficients::Zero()), "imu_entropy"), 2.7513, 1e-4);
  EXPECT_GT(Term(FirstStep({}), "imu_entropy"), 5.0);
}

TEST(ExtrinsicMistakes, ConditionalCovarianceIsSmallerThanTheMarginalOne) {
  const StepResult right = FirstStep({});
  const StepResult wrong = FirstStep({Mistake::kConditionalCovariance});
  const double conditional = -Term(wrong, "information") / 1e7;
  const auto block = [&](int first) {
    return (2.0 * right.observation.segment(6 + first, 6).array()).exp().sum() * 1e-6;
  };
  EXPECT_GT(conditional, 0.0);
  EXPECT_LT(conditional, 0.5 * block(0));  // rad^2 + m^2 both
  EXPECT_EQ(right.observation, wrong.observation);
}

TEST(ExtrinsicMistakes, SwappedNoiseChangesTheEstimateAndWhatItClaims) {
  const StepResult right = FirstStep({});
  const StepResult wrong = FirstStep({Mistake::kSwappedNoise});
  // The accelerometer is believed to be 14 times worse: the worst direction is claimed to be wider.
  EXPECT_GT(wrong.observation(11), right.observation(11) + 0.5);
  EXPECT_EQ(Term(right, "imu_entropy"), Term(wrong, "imu_entropy"));
}

TEST(ExtrinsicMistakes, TheWrongTruthIsUpToThreeMillimetresOff) {
  for (const Eigen::Vector3d& rpy :
       {Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d(0.0, 0.0, -0.1)}) {
    const Rigid3 truth{RotationFromRpy(rpy) * PriorMeanExtrinsics().R, {0.06, 0.0, -0.1}};
    const Rigid3 wrong = OriginalTruth(truth);
    EXPECT_EQ(wrong.R, truth.R);
    // The slide is along x of the camera: turned about it, nothing; about z, 0.03 m * 0.1 rad.
    EXPECT_NEAR((wrong.t - truth.t).norm(), std::abs(rpy.z()) * 0.03, 1e-5);
  }
  EXPECT_NE(Term(FirstStep({Mistake::kWrongTruth}), "relative_error"),
            Term(FirstStep({}), "relative_error"));
}

TEST(ExtrinsicMistakes, SilentRefusalsCostNothingAndLookLikeAnOutcome) {
  ExtrinsicTask task;
  task.mistakes = {Mistake::kSilentRefusals};
  ExtrinsicEnvironment environment(task);
  (void)environment.Reset(Rng(1));
  LoopCoefficients too_far = LoopCoefficients::Zero();
  too_far(1) = 0.5;
  const StepResult refused = environment.Step(too_far);
  EXPECT_FALSE(refused.executed);
  EXPECT_EQ(refused.reward, 0.0);
  EXPECT_EQ(refused.observation, Eigen::VectorXd::Zero(12));
}

}  // namespace
}  // namespace calibrato
