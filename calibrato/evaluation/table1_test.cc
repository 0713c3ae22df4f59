#include "calibrato/evaluation/table1.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "calibrato/base/parallel.h"
#include "calibrato/evaluation/table1_document.h"

namespace calibrato {
namespace {

constexpr int kNumRigs = 3;

Table1Options SmallOptions() {
  Table1Options options;
  options.setting.num_rigs = kNumRigs;
  return options;
}

const Table1Row& RowOf(const Table1& table, const std::string& policy) {
  for (const Table1Row& row : table.rows) {
    if (row.policy == policy) return row;
  }
  throw std::runtime_error("no row " + policy);
}

Motion HandcraftedTimes(double factor) {
  Motion motion = HandcraftedMotion(Task::kIntrinsic);
  for (Loop& loop : motion.loops) loop.coefficients *= factor;
  return motion;
}

// Evaluated once for all tests, as the next one.
const Table1& SmallIntrinsicTable() {
  static const Table1 table = [] {
    Table1Options options = SmallOptions();
    options.motions = {{"again", HandcraftedTimes(1.0), {}},
                       {"short", HandcraftedTimes(0.5), {}},
                       {"large", HandcraftedTimes(1.5), {}}};
    return EvaluateTable1(options);
  }();
  return table;
}

TEST(Table1, HasItsRowsInTheirOrder) {
  std::vector<std::string> policies;
  for (const Table1Row& row : SmallIntrinsicTable().rows) policies.push_back(row.policy);
  EXPECT_EQ(policies, std::vector<std::string>(
                          {"random", "handcrafted", "again", "again at random's path", "short",
                           "large", "large at random's path", "random at handcrafted's path",
                           "expert", "expert at handcrafted's path"}));
}

TEST(Table1, RatiosOfTwoRowsAreEachOthersInverse) {
  const Table1Row& random = RowOf(SmallIntrinsicTable(), "random");
  const Table1Row& handcrafted = RowOf(SmallIntrinsicTable(), "handcrafted");
  EXPECT_EQ(handcrafted.to_handcrafted.ratio, 1.0);
  EXPECT_NEAR(random.to_handcrafted.ratio * handcrafted.to_random.ratio, 1.0, 1e-12);
}

TEST(Table1, AMotionUnderAnotherNameHasTheSameErrors) {
  const Table1Row& again = RowOf(SmallIntrinsicTable(), "again");
  const Table1Row& handcrafted = RowOf(SmallIntrinsicTable(), "handcrafted");
  for (size_t i = 0; i < kNumRigs; ++i) {
    EXPECT_EQ(again.trials[0][i].relative_error, handcrafted.trials[0][i].relative_error);
  }
  EXPECT_EQ(again.to_handcrafted.ci95.low, 1.0);
  EXPECT_EQ(again.to_handcrafted.ci95.high, 1.0);
}

TEST(Table1, ALongerMotionHasASecondRowAtTheLengthOfTheRandomOnes) {
  const Table1Row& random = RowOf(SmallIntrinsicTable(), "random");
  const Table1Row& shrunk = RowOf(SmallIntrinsicTable(), "again at random's path");
  EXPECT_NEAR(shrunk.trials[0][0].path_length_m, random.MeanOf(&Trial::path_length_m), 1e-9);
}

TEST(Table1, HasThePathsOfThePaper) {
  const Value document = ToValue({SmallIntrinsicTable()});
  EXPECT_EQ(document.At("kind").AsString(), "table1");
  const Value& handcrafted = document.At("rows").elements()[1];
  EXPECT_NEAR(handcrafted.At("path_length_original_m").AsDouble(), 11.1156, 1e-4);
  EXPECT_NEAR(handcrafted.At("path_length_m").AsDouble(), 11.3641, 1e-4);
  EXPECT_EQ(handcrafted.At("n").AsInt(), kNumRigs);
}

TEST(Table1, AMotionTooLargeForItsCarrierIsScaledAndItsRowSaysSo) {
  EXPECT_LT(RowOf(SmallIntrinsicTable(), "large").scale, 0.9);
  EXPECT_EQ(RowOf(SmallIntrinsicTable(), "handcrafted").scale, 1.0);
}

TEST(Table1, EveryTrialIsALineOfTheList) {
  const std::string csv = TrialsCsv({SmallIntrinsicTable()});
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 10 * kNumRigs);
}

TEST(Table1, IsTheSameToTheByteForAnyNumberOfThreads) {
  Table1Options options = SmallOptions();
  options.setting.num_rigs = 2;
  SetNumThreads(1);
  const std::string one = ToJson(ToValue({EvaluateTable1(options)}));
  SetNumThreads(3);
  const std::string three = ToJson(ToValue({EvaluateTable1(options)}));
  SetNumThreads(0);
  EXPECT_EQ(one, three);
}

// 24 rigs: its bound is about half of theirs.
TEST(Table1, TheHandcraftedMotionIsBetterThanRandomOnes) {
  ContestSetting setting;
  setting.num_rigs = 24;
  const std::vector<Rig> rigs = RigsUnderTrial(setting);
  const ContestTrials trials =
      RunContest(setting, rigs,
                 {RandomContestant(Task::kIntrinsic, Carrier::kFree, rigs, Rng(1)),
                  FixedContestant("handcrafted", HandcraftedTimes(1.0), Carrier::kFree,
                                  PlanningScene(setting))});
  EXPECT_LT(PairedRatio(FiguresOf(trials[1], &Trial::relative_error),
                        FiguresOf(trials[0], &Trial::relative_error)),
            0.8);
}

Table1Options SmallExtrinsicOptions() {
  Table1Options options = SmallOptions();
  options.setting.task = Task::kExtrinsic;
  options.setting.num_rigs = 2;
  return options;
}

// Evaluated once for all tests.
const Table1& SmallExtrinsicTable() {
  static const Table1 table = EvaluateTable1(SmallExtrinsicOptions());
  return table;
}

TEST(Table1, TheExtrinsicRowsHaveEveryKeyOfTheirTask) {
  const Value document = ToValue({SmallExtrinsicTable()});
  const Value& handcrafted = document.At("rows").elements()[1];
  EXPECT_EQ(handcrafted.At("task").AsString(), "extrinsic");
  EXPECT_NEAR(handcrafted.At("path_length_original_m").AsDouble(), 3.3062, 1e-4);
  EXPECT_NEAR(handcrafted.At("motion_s").AsDouble(), 15.0, 1e-9);
  for (const char* key :
       {"mean_error_percent", "median_error_percent", "prediction_error_px", "translation_error_m",
        "rotation_error_rad", "time_offset_error_s", "a_optimality", "a_optimality_conditional",
        "a_optimality_original", "error_over_bound", "ratio_to_best_simple_rival"}) {
    EXPECT_GT(handcrafted.At(key).AsDouble(), 0.0) << key;
  }
  EXPECT_EQ(handcrafted.Find("focal_error_px"), nullptr);
  EXPECT_EQ(handcrafted.At("paper_mean_error_percent").AsDouble(), 0.340);
  EXPECT_EQ(handcrafted.At("intervals").At("translation_error_m").size(), 2U);
}

TEST(Table1, EveryRowsMotionIsDrawnAndPlayed) {
  const Table1& table = SmallExtrinsicTable();
  const Value plots = Table1Plots({table});
  const auto& motions = plots.At("motions").elements();
  ASSERT_EQ(motions.size(), table.rows.size());
  for (size_t k = 0; k < motions.size(); ++k) {
    EXPECT_EQ(motions[k].At("policy").AsString(), table.rows[k].policy);
    EXPECT_EQ(motions[k].At("carrier").AsString(), "free");
    EXPECT_GT(motions[k].At("played").At("camera_b").size(), 10U);
  }
  EXPECT_EQ(plots.At("board_outline_b").size(), 4U);
}

TEST(Table1, TheBestSimpleRivalIsNoLongerThanTheHandcraftedMotion) {
  const Table1& table = SmallExtrinsicTable();
  const Table1Row& best = RowOf(table, table.best_simple_rival);
  const Table1Row& handcrafted = RowOf(table, "handcrafted");
  EXPECT_LE(best.mean_error, handcrafted.mean_error);
  EXPECT_LE(best.MeanOf(&Trial::path_length_m),
            handcrafted.MeanOf(&Trial::path_length_m) * (1.0 + 1e-9));
  EXPECT_EQ(best.to_best_simple_rival.ratio, 1.0);
  EXPECT_NEAR(RowOf(table, "random at handcrafted's path").MeanOf(&Trial::path_length_m),
              handcrafted.MeanOf(&Trial::path_length_m), 1e-9);
}

}  // namespace
}  // namespace calibrato
