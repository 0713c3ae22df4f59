#include "calibrato/base/required_keys.h"

#include <gtest/gtest.h>

#include "calibrato/base/input_error_testing.h"

namespace calibrato {
namespace {

const std::vector<std::string> kWanted = {"targetCols", "targetRows"};

TEST(RequireKeys, NeverTakesOneWantedKeyForAnother) {
  EXPECT_EQ(InputErrorOf([] { RequireKeys(ParseYaml("targetRows: 6", "b"), kWanted); }),
            "missing key targetCols, b line 1: the keys here are targetRows; "
            "add 'targetCols: ...'");
}

TEST(RequireKeys, SuggestsTheMisspeltOneAmongTheRest) {
  EXPECT_EQ(
      InputErrorOf([] { RequireKeys(ParseYaml("targetRows: 6\ntargetColls: 7", "b"), kWanted); }),
      "missing key targetCols, b line 1: the keys here are targetRows, targetColls; "
      "did you mean targetCols where targetColls stands?");
}

TEST(RequireKeys, SaysNothingWhereAllAreThere) {
  EXPECT_NO_THROW(RequireKeys(ParseYaml("targetRows: 6\nx: 1\ntargetCols: 7", "b"), kWanted));
}

TEST(RequireKeys, OfNothingMissesTheFirst) {
  EXPECT_EQ(InputErrorOf([] { RequireKeys(ParseYaml("", "b"), kWanted); }),
            "missing key targetCols, b line 1: there are no keys here; add 'targetCols: ...'");
}

}  // namespace
}  // namespace calibrato
