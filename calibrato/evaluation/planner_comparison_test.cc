#include "calibrato/evaluation/planner_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/evaluation/ablation.h"
#include "calibrato/mdp/design_setting.h"

namespace calibrato {
namespace {

ContestSetting Small() {
  ContestSetting setting;
  setting.task = Task::kExtrinsic;
  setting.num_rigs = 4;
  return setting;
}

Motion Handcrafted(double scale) {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  for (Loop& loop : motion.loops) loop.coefficients *= scale;
  return motion;
}

Value RowOf(const Value& document, const std::string& policy) {
  for (const Value& row : document.At("rows").elements()) {
    if (row.At("policy").AsString() == policy) return row;
  }
  ADD_FAILURE() << "no row " << policy;
  return {};
}

// The handcrafted motion itself has its own loss and errors; with half the offsets it has more.
TEST(ComparePlanners, ComparesWithTheHandcraftedMotion) {
  MotionDesignProblem problem;
  problem.task = Task::kExtrinsic;
  problem.rigs = {AsEstimated(PaperRig())};
  problem.num_loops = 3;
  const auto design = [&](double scale) {
    return MotionDesign{Handcrafted(scale), ExpectLoss(problem, Handcrafted(scale)).value, 90};
  };
  const PlannerComparison comparison =
      ComparePlanners(Small(), problem,
                      {{"same", 100, {design(1.0)}}, {"smaller", 100, {design(0.5), design(0.4)}}});
  const Value document = ToValue({comparison});
  const Value same = RowOf(document, "same, 100");
  EXPECT_NEAR(same.At("expected_loss").AsDouble(), 0.0, 1e-12);
  EXPECT_EQ(same.At("ratio_to_handcrafted").AsDouble(), 1.0);
  EXPECT_EQ(same.At("information_evaluations").AsDouble(), 90.0);
  const Value smaller = RowOf(document, "smaller, 100");
  EXPECT_EQ(smaller.At("num_training_seeds").AsInt(), 2);
  EXPECT_GT(smaller.At("expected_loss").AsDouble(), 0.3);
  const std::vector<double> range = smaller.At("expected_loss_range").AsDoubles(2);
  EXPECT_NEAR(0.5 * (range[0] + range[1]), smaller.At("expected_loss").AsDouble(), 1e-12);
  EXPECT_LT(range[0], range[1]);
  const std::vector<Chart> charts = ChartsOf({comparison});
  ASSERT_EQ(charts.front().series.size(), 2U);
  EXPECT_NEAR(charts.front().series[0].y[0], 1.0, 1e-12);
}

TEST(EvaluateAblation, ComparesWithItsFirstVariant) {
  const Ablation ablation =
      EvaluateAblation(Small(), {{"baseline", Handcrafted(1.0), "done", 200, 600},
                                 {"mistake x", Handcrafted(0.4), "done", 200, 600},
                                 {"refused", {}, "nothing executed", 200, 0}});
  const Value document = ToValue({ablation});
  const Value baseline = RowOf(document, "baseline");
  EXPECT_EQ(baseline.Find("ratio_to_baseline"), nullptr);
  EXPECT_EQ(baseline.At("ratio_to_handcrafted").AsDouble(), 1.0);
  const Value worse = RowOf(document, "mistake x");
  EXPECT_GT(worse.At("ratio_to_baseline").AsDouble(), 1.2);
  EXPECT_LE(worse.At("probability_as_baseline").AsDouble(), 1.0);
  EXPECT_EQ(worse.At("episodes").AsInt(), 200);
  const Value refused = RowOf(document, "refused");
  EXPECT_EQ(refused.Find("mean_error_percent"), nullptr);
  EXPECT_EQ(refused.At("termination").AsString(), "nothing executed");
  EXPECT_EQ(RowOf(document, "handcrafted").At("ratio_to_baseline").AsDouble(), 1.0);
  EXPECT_EQ(ChartsOf({ablation}).front().series.size(), 2U);  // "mistake x" and handcrafted.
}

}  // namespace
}  // namespace calibrato
