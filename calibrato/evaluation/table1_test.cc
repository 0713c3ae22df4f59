#include "calibrato/evaluation/table1.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/parallel.h"
#include "calibrato/evaluation/table1_document.h"

namespace calibrato {
namespace {

Table1Options SmallOptions() {
  Table1Options options;
  options.num_rigs = 6;
  return options;
}

TEST(Table1, RanksTheHandcraftedMotionAboveRandomOnes) {
  Table1Options options;
  options.num_rigs = 24;
  const Table1 table = EvaluateTable1(options);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].policy, "random");
  EXPECT_EQ(table.rows[1].policy, "handcrafted");
  // Its bound is about half of theirs.
  EXPECT_LT(table.rows[1].mean_error, table.rows[0].mean_error);
  EXPECT_EQ(table.rows[1].ratio_to_handcrafted, 1.0);
  EXPECT_NEAR(table.rows[0].ratio_to_handcrafted * table.rows[1].ratio_to_random, 1.0, 1e-12);
}

TEST(Table1, AMotionUnderAnotherNameHasTheSameErrors) {
  Table1Options options = SmallOptions();
  options.motions = {{"again", HandcraftedMotion(Task::kIntrinsic)}};
  const Table1 table = EvaluateTable1(options);
  ASSERT_EQ(table.rows.size(), 4U);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(table.rows[2].trials[i].relative_error, table.rows[1].trials[i].relative_error);
  }
  EXPECT_EQ(table.rows[2].ratio_ci95.low, 1.0);
  EXPECT_EQ(table.rows[2].ratio_ci95.high, 1.0);
}

TEST(Table1, ALongerMotionHasASecondRowAtTheLengthOfTheRandomOnes) {
  Table1Options options = SmallOptions();
  Motion shorter = HandcraftedMotion(Task::kIntrinsic);
  for (Loop& loop : shorter.loops) loop.coefficients *= 0.5;
  options.motions = {{"long", HandcraftedMotion(Task::kIntrinsic)}, {"short", shorter}};
  const Table1 table = EvaluateTable1(options);
  ASSERT_EQ(table.rows.size(), 5U);
  EXPECT_EQ(table.rows[3].policy, "long at random's path");
  double random_path = 0.0;
  for (const Trial& trial : table.rows[0].trials) random_path += trial.path_length_m / 6.0;
  EXPECT_NEAR(table.rows[3].trials[0].path_length_m, random_path, 1e-9);
  EXPECT_EQ(table.rows[4].policy, "short");
}

TEST(Table1, IsTheSameToTheByteForAnyNumberOfThreads) {
  SetNumThreads(1);
  const std::string one = ToJson(ToValue(EvaluateTable1(SmallOptions())));
  SetNumThreads(3);
  const std::string three = ToJson(ToValue(EvaluateTable1(SmallOptions())));
  SetNumThreads(0);
  EXPECT_EQ(one, three);
}

TEST(Table1, HasThePathsOfThePaper) {
  const Value document = ToValue(EvaluateTable1(SmallOptions()));
  EXPECT_EQ(document.At("kind").AsString(), "table1");
  const Value& handcrafted = document.At("rows").elements()[1];
  EXPECT_NEAR(handcrafted.At("path_length_original_m").AsDouble(), 11.1156, 1e-4);
  EXPECT_NEAR(handcrafted.At("path_length_m").AsDouble(), 11.3641, 1e-4);
  EXPECT_EQ(handcrafted.At("n").AsInt(), 6);
}

TEST(Table1, AMotionTooLargeForItsCarrierIsScaledAndItsRowSaysSo) {
  Table1Options options = SmallOptions();
  Motion large = HandcraftedMotion(Task::kIntrinsic);
  for (Loop& loop : large.loops) loop.coefficients *= 1.5;
  options.motions = {{"large", large}};
  const Table1 table = EvaluateTable1(options);
  EXPECT_LT(table.rows[2].scale, 0.9);
  EXPECT_EQ(table.rows[1].scale, 1.0);
}

}  // namespace
}  // namespace calibrato
