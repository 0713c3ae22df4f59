#include "calibrato/learning/mpc.h"

#include <gtest/gtest.h>

#include <set>

namespace calibrato {
namespace {

HistoryModel SomeModel() {
  NetworkOptions options;
  options.hidden_size = 16;
  Rng rng(3);
  return {2, options, 0.015, rng};
}

const History kStart{{Eigen::Vector2d(0.5, -0.5)}, {}};
const Eigen::MatrixXd kNothing(72, 0);

TEST(PlanAction, TakesTheBestParticleInTests) {
  const HistoryModel model = SomeModel();
  Rng rng(1);
  const Plan plan =
      PlanAction(model, kStart, 2, kNothing, PlanningOptions(), Exploration::kTesting, rng);
  ASSERT_EQ(plan.best.rows(), 72);
  ASSERT_EQ(plan.best.cols(), 5);
  EXPECT_EQ(plan.action, plan.best.col(0).head<36>());
  const Eigen::VectorXd values =
      model.PredictReturns(model.Encode(kStart), plan.best, false).values;
  EXPECT_FLOAT_EQ(plan.predicted_return, values[0]);
  for (int i = 1; i < 5; ++i) EXPECT_LE(values[i], values[i - 1]);
}

TEST(PlanAction, TakesEachOfTheBestWhileTraining) {
  const HistoryModel model = SomeModel();
  std::set<int> chosen;
  for (uint64_t seed = 0; seed < 60; ++seed) {
    Rng rng(seed);
    const Plan plan =
        PlanAction(model, kStart, 2, kNothing, PlanningOptions(), Exploration::kTraining, rng);
    for (int i = 0; i < plan.best.cols(); ++i) {
      if (plan.best.col(i).head<36>() == plan.action) chosen.insert(i);
    }
  }
  EXPECT_EQ(chosen, (std::set<int>{0, 1, 2, 3, 4}));
}

TEST(PlanAction, GetsBetterFromWhatItRemembers) {
  const HistoryModel model = SomeModel();
  PlanningOptions options;
  options.swarm.gradient_weight = 1e-3;
  Eigen::MatrixXd remembered = kNothing;
  double first = 0.0;
  double last = 0.0;
  for (int episode = 0; episode < 30; ++episode) {
    Rng rng(static_cast<uint64_t>(episode));
    const Plan plan = PlanAction(model, kStart, 2, remembered, options, Exploration::kTesting, rng);
    remembered = plan.best;
    if (episode == 0) first = plan.predicted_return;
    last = plan.predicted_return;
  }
  EXPECT_GT(last, first + 0.1);
}

TEST(PlanAction, RanksWhatEveryPlannerFound) {
  const HistoryModel model = SomeModel();
  for (const std::string& planner : ModelPlannerNames()) {
    SCOPED_TRACE(planner);
    PlanningOptions options;
    options.planner = planner;
    Rng rng(1);
    const Plan plan = PlanAction(model, kStart, 2, kNothing, options, Exploration::kTesting, rng);
    ASSERT_EQ(plan.best.cols(), 5);
    EXPECT_EQ(plan.action, plan.best.col(0).head<36>());
    EXPECT_LE(plan.best.cwiseAbs().maxCoeff(), 0.015);
    const Eigen::VectorXd values =
        model.PredictReturns(model.Encode(kStart), plan.best, false).values;
    // Batches of other sizes may differ in the last bit of a float.
    EXPECT_NEAR(plan.predicted_return, values[0], 1e-5);
    for (int i = 1; i < 5; ++i) EXPECT_LE(values[i], values[i - 1] + 1e-5);
    EXPECT_NEAR(plan.best_so_far.back(), values[0], 1e-5);
    // What it is given is where it begins: never worse than that.
    Rng other(2);
    const Plan later =
        PlanAction(model, kStart, 2, plan.best, options, Exploration::kTesting, other);
    EXPECT_GE(later.predicted_return, plan.predicted_return - 1e-5);
  }
}

TEST(PlanAction, GivesEveryPlannerTheSameBudget) {
  PlanningOptions options;
  EXPECT_EQ(NumEvaluations(options), 90);
  options.swarm.num_iterations = 9;
  EXPECT_EQ(NumEvaluations(options), 150);
}

}  // namespace
}  // namespace calibrato
