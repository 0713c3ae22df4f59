#include "calibrato/base/progress_line.h"

#include <gtest/gtest.h>

#include <limits>

namespace calibrato {
namespace {

TEST(FormatProgressLine, ShowsShareCountTimeLeftAndRemark) {
  // 1 s a piece so far, 3 pieces left.
  EXPECT_EQ(FormatProgressLine({"detecting", 1, 4, 1.0, "rms 0.21"}, 200),
            "detecting  [=====>              ]   25 %  1/4  3 s left  rms 0.21");
}

TEST(FormatProgressLine, KnowsNoTimeLeftBeforeTheFirstIsDone) {
  EXPECT_EQ(FormatProgressLine({"x", 0, 4, 9.0, ""}, 200), "x  [>                   ]    0 %  0/4");
}

TEST(FormatProgressLine, EndsFull) {
  EXPECT_EQ(FormatProgressLine({"x", 5, 4, 9.0, ""}, 200),
            "x  [====================]  100 %  4/4  0 s left");
}

TEST(FormatProgressLine, CountsOnlyWhereTheTotalIsUnknown) {
  EXPECT_EQ(FormatProgressLine({"x", 12, 0, 1.0, "r"}, 200), "x  12  r");
}

TEST(FormatProgressLine, NeverExceedsTheWidth) {
  for (size_t width = 0; width < 80; ++width) {
    EXPECT_LE(FormatProgressLine({"a title", 1, 2, 3.0, "a remark"}, width).size(), width);
  }
}

TEST(FormatTimeSpan, ChoosesItsUnits) {
  EXPECT_EQ(FormatTimeSpan(0.0), "0 s");
  EXPECT_EQ(FormatTimeSpan(2.1), "3 s");
  EXPECT_EQ(FormatTimeSpan(125.0), "2 min 05 s");
  EXPECT_EQ(FormatTimeSpan(4020.0), "1 h 07 min");
  EXPECT_EQ(FormatTimeSpan(-1.0), "0 s");
  EXPECT_EQ(FormatTimeSpan(std::numeric_limits<double>::quiet_NaN()), "0 s");
}

}  // namespace
}  // namespace calibrato
