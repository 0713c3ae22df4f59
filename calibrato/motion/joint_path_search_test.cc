#include "calibrato/motion/joint_path_search.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

// In the middle of all limits but for the first and the last joint.
JointVector Joints(double q1, double q7) {
  JointVector q = 0.5 * (Limits().lower + Limits().upper);
  q[0] = q1;
  q[6] = q7;
  return q;
}

JointChoices OneLoop(const std::vector<JointVector>& start, const std::vector<JointVector>& inner) {
  JointChoices choices;
  choices.start = start;
  choices.loops.emplace_back().fill(inner);
  return choices;
}

TEST(SearchJointPaths, StartsWhereTheWholeLoopIsCheapest) {
  const JointChoices choices =
      OneLoop({Joints(0.0, 0.0), Joints(0.3, 0.0)}, {Joints(0.3, 0.0), Joints(0.6, 0.0)});
  const auto search = SearchJointPaths(choices, {});
  const auto& paths = std::get<std::vector<JointPath>>(search);
  ASSERT_EQ(paths.size(), 1u);  // the other start differs in the shoulder alone
  const JointPath& path = paths[0];
  for (int i = 0; i <= 62; ++i) EXPECT_EQ(path.At(0, i)[0], 0.3);
}

TEST(SearchJointPaths, LooksAheadRatherThanTakeTheNearest) {
  // Halfway all must be at 1.0 and at 2.0 at the end of the walk; standing still until then would
  // be cheapest step by step, but leaps are not allowed and long steps cost more than short ones.
  std::vector<JointVector> grid;
  for (int i = 0; i <= 20; ++i) grid.push_back(Joints(0.05 * i, 0.0));
  JointChoices choices = OneLoop({Joints(0.0, 0.0)}, grid);
  choices.loops[0][30] = {Joints(1.0, 0.0)};
  const auto search = SearchJointPaths(choices, {});
  const JointPath& path = std::get<std::vector<JointPath>>(search)[0];
  for (int i = 1; i <= 62; ++i) {
    EXPECT_LE(std::abs(path.At(0, i)[0] - path.At(0, i - 1)[0]), 0.05 + 1e-12);
  }
}

TEST(SearchJointPaths, UsesOneStartForAllLoops) {
  // The first loop alone would start at 0.3, two others draw the start to 0.
  JointChoices choices = OneLoop({Joints(0.0, 0.0), Joints(0.3, 0.0)}, {Joints(0.3, 0.0)});
  for (int i = 0; i < 2; ++i) choices.loops.emplace_back().fill({Joints(0.0, 0.0)});
  const auto search = SearchJointPaths(choices, {});
  EXPECT_EQ(std::get<std::vector<JointPath>>(search)[0].start[0], 0.0);
}

TEST(SearchJointPaths, OffersStartsThatDifferInTheWrist) {
  const JointChoices choices = OneLoop({Joints(0.0, -1.5), Joints(0.0, 0.0), Joints(0.0, 0.5)},
                                       {Joints(0.0, -1.5), Joints(0.0, 0.0), Joints(0.0, 0.5)});
  const auto search = SearchJointPaths(choices, {});
  const auto& paths = std::get<std::vector<JointPath>>(search);
  ASSERT_EQ(paths.size(), 2u);  // 0 and 0.5 are much the same
  EXPECT_GT(std::abs(paths[0].start[6] - paths[1].start[6]), 1.2);
}

TEST(SearchJointPaths, NamesTheGapThatNoPathCrosses) {
  JointChoices choices = OneLoop({Joints(0.0, 0.0)}, {Joints(0.3, 0.0)});
  choices.loops[0][9] = {Joints(1.5, 0.0)};
  const auto search = SearchJointPaths(choices, {});
  ASSERT_TRUE(std::holds_alternative<Refusal>(search));
  const Refusal& refusal = std::get<Refusal>(search);
  EXPECT_EQ(refusal.loop, 0);
  EXPECT_EQ(refusal.way_point, 10);
  EXPECT_NEAR(refusal.value, 1.2, 1e-12);
  EXPECT_EQ(refusal.bound, kMaxJointStep);
}

TEST(SearchJointPaths, RefusesALoopThatCannotCloseAtItsStart) {
  // Slow walks of two starts end at the other one.
  std::vector<JointVector> grid;
  JointChoices choices = OneLoop({Joints(0.0, 0.0), Joints(2.0, 0.0)}, {});
  for (int i = 0; i < 61; ++i) {
    const double walked = 2.0 * (i + 1) / 62.0;
    choices.loops[0][i] = {Joints(walked, 0.0), Joints(-5.0, 0.0)};
  }
  const auto search = SearchJointPaths(choices, {});
  ASSERT_TRUE(std::holds_alternative<Refusal>(search));
  EXPECT_EQ(std::get<Refusal>(search).way_point, 62);
}

}  // namespace
}  // namespace calibrato
