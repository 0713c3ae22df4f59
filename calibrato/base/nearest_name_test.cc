#include "calibrato/base/nearest_name.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

const std::vector<std::string> kKeys = {"targetCols", "targetRows", "rowSpacingMeters",
                                        "colSpacingMeters"};

TEST(NearestName, FindsWhatWasMeant) {
  EXPECT_EQ(NearestName("targetcols", kKeys), "targetCols");
  EXPECT_EQ(NearestName("targetColumns", kKeys), "targetCols");
  EXPECT_EQ(NearestName("targteRows", kKeys), "targetRows");
  EXPECT_EQ(NearestName("rowSpacing_Meters", kKeys), "rowSpacingMeters");
}

TEST(NearestName, FindsNothingWhereNothingIsNear) {
  EXPECT_EQ(NearestName("rate", kKeys), std::nullopt);
  EXPECT_EQ(NearestName("", kKeys), std::nullopt);
  EXPECT_EQ(NearestName("x", {}), std::nullopt);
  EXPECT_EQ(NearestName(std::string(1000, 'x'), kKeys), std::nullopt);
}

TEST(NearestName, CountsASwapOfNeighboursAsOneChange) {
  EXPECT_EQ(NearestName("abc", {"xbd", "acb"}), "acb");  // one of three letters: just near enough
  EXPECT_EQ(NearestName("abc", {"cab"}), std::nullopt);
}

TEST(NearestName, TakesTheFirstOfEquallyNear) {
  EXPECT_EQ(NearestName("cam2", {"cam0", "cam1"}), "cam0");
}

}  // namespace
}  // namespace calibrato
