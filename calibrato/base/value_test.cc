#include "calibrato/base/value.h"

#include <gtest/gtest.h>

#include <limits>

#include "calibrato/base/input_error_testing.h"

namespace calibrato {
namespace {

// As a board's file.
Value Board() {
  return ParseYaml(
      "target_type: checkerboard\n"
      "targetCols: six\n"
      "rowSpacingMeters: -0.06\n"
      "quoted: '6'\n"
      "cam0:\n"
      "  intrinsics: [1, 2, x]\n"
      "  rows: [[1, 2], [3]]\n"
      "empty:\n",
      "board.yaml");
}

TEST(Value, MissingKeyNamesFileLineAndRemedy) {
  EXPECT_EQ(InputErrorOf([] { ParseYaml("a: 1\nb: 2\n", "board.yaml").At("targetRows"); }),
            "missing key targetRows, board.yaml line 1: the keys here are a, b; "
            "add 'targetRows: ...'");
  EXPECT_EQ(InputErrorOf([] { Board().At("cam0").At("distortion"); }),
            "missing key distortion, board.yaml line 5, key cam0: the keys here are intrinsics, "
            "rows; add 'distortion: ...'");
}

TEST(Value, MissingKeySuggestsTheMisspeltOne) {
  const std::string message =
      InputErrorOf([] { ParseYaml("targetrows: 6", "b").At("targetRows"); });
  EXPECT_NE(message.find("did you mean targetRows where targetrows stands?"), std::string::npos)
      << message;
}

TEST(Value, EmptyFileMissesEveryKey) {
  const Value empty = ParseYaml("", "empty.yaml");
  EXPECT_EQ(empty.Find("x"), nullptr);
  EXPECT_TRUE(empty.UnknownKeys({}).empty());
  EXPECT_EQ(InputErrorOf([&] { empty.At("x"); }),
            "missing key x, empty.yaml line 1: there are no keys here; add 'x: ...'");
}

TEST(Value, WrongTypeNamesFileLineKeyExpectedAndFound) {
  EXPECT_EQ(InputErrorOf([] { Board().At("targetCols").AsInt(); }),
            "wrong type, board.yaml line 2, key targetCols: expected a whole number, found 'six'; "
            "write digits only, as in 6, without quotes, point or unit");
  EXPECT_NE(
      InputErrorOf([] {
        Board().At("cam0").At("intrinsics").AsDoubles();
      }).find("board.yaml line 6, key cam0.intrinsics[2]: expected a finite number, found 'x'"),
      std::string::npos);
  EXPECT_NE(InputErrorOf([] { Board().At("quoted").AsInt(); }).find("found the text \"6\""),
            std::string::npos);
  EXPECT_NE(InputErrorOf([] { Board().At("empty").AsDouble(); })
                .find("line 8, key empty: "
                      "expected a finite number, "
                      "found nothing"),
            std::string::npos);
  EXPECT_THROW(Board().At("cam0").AsString(), InputError);
  EXPECT_THROW(Board().At("targetCols").At("x"), InputError);
  EXPECT_THROW(Board().At("targetCols").members(), InputError);
  EXPECT_THROW(Board().At("targetCols").elements(), InputError);
}

TEST(Value, RangesIncludeTheirEnds) {
  EXPECT_EQ(Value(2).AsInt(2, 5), 2);
  EXPECT_EQ(Value(5).AsInt(2, 5), 5);
  EXPECT_EQ(InputErrorOf([] { Value(6).AsInt(2, 5); }),
            "value out of range: expected a whole number from 2 to 5, found 6; "
            "choose one within these limits");
  EXPECT_THROW(Value(1).AsInt(2, 5), InputError);
  EXPECT_THROW(Value(0).AsPositive(), InputError);
  EXPECT_EQ(Value(1e-300).AsPositive(), 1e-300);
  EXPECT_EQ(Value(0.0).AsNonNegative(), 0.0);
  EXPECT_THROW(Board().At("rowSpacingMeters").AsNonNegative(), InputError);
}

TEST(Value, AccessorsTakeOnlyTheirOwnType) {
  EXPECT_TRUE(Value(true).AsBool());
  EXPECT_THROW(Value(1).AsBool(), InputError);
  EXPECT_THROW(Value("true").AsBool(), InputError);
  EXPECT_EQ(Value(3).AsDouble(), 3.0);
  EXPECT_THROW(Value(3.0).AsInt(), InputError);
  EXPECT_THROW(Value("3").AsDouble(), InputError);
  EXPECT_THROW(Value(3).AsString(), InputError);
  EXPECT_THROW(Value().AsString(), InputError);
}

TEST(Value, AsDoubleRefusesWhatIsNotFinite) {
  EXPECT_THROW(Value(std::numeric_limits<double>::quiet_NaN()).AsDouble(), InputError);
  EXPECT_THROW(Value(std::numeric_limits<double>::infinity()).AsDouble(), InputError);
  EXPECT_THROW(Value(-std::numeric_limits<double>::infinity()).AsNonNegative(), InputError);
}

TEST(Value, AsDoublesFlattensRowsAndChecksShape) {
  const Value matrix = ParseYaml("[[1, 2], [3, 4]]", "m");
  EXPECT_EQ(matrix.AsDoubles(4), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_NE(InputErrorOf([&] {
              matrix.AsDoubles(3);
            }).find("wrong size, m line 1: expected an array of 3 numbers, found 4"),
            std::string::npos);
  EXPECT_NE(InputErrorOf([] {
              Board().At("cam0").At("rows").AsDoubles();
            }).find("line 7, key cam0.rows[1]: expected a row of 2 as the first, found 1"),
            std::string::npos);
  EXPECT_THROW(ParseYaml("[1, [2]]", "m").AsDoubles(), InputError);
  EXPECT_THROW(ParseYaml("[[1], 2]", "m").AsDoubles(), InputError);
  EXPECT_THROW(Value(1.0).AsDoubles(1), InputError);
  EXPECT_TRUE(Value::Array().AsDoubles().empty());
}

TEST(Value, UnknownKeysNameTheNearestKnown) {
  const Value value =
      ParseYaml("targetcols: 6\ntargetRows: 7\nzzz: 1\ncam0:\n  modle: x\n", "b.yaml");
  EXPECT_EQ(
      value.UnknownKeys({"targetCols", "targetRows", "cam0"}),
      (std::vector<std::string>{"unknown key targetcols, b.yaml line 1; did you mean targetCols?",
                                "unknown key zzz, b.yaml line 3; ignored"}));
  EXPECT_EQ(
      value.At("cam0").UnknownKeys({"model"}),
      (std::vector<std::string>{"unknown key cam0.modle, b.yaml line 5; did you mean model?"}));
}

TEST(Value, SetKeepsTheOrderAndReplacesInPlace) {
  Value value;
  value.Set("b", 1).Set("a", 2).Set("b", "three");
  ASSERT_EQ(value.size(), 2U);
  EXPECT_EQ(value.members()[0].first, "b");
  EXPECT_EQ(value.At("b").AsString(), "three");
  EXPECT_EQ(value.At("a").AsInt(), 2);
}

TEST(Value, FindTakesNullForAbsent) {
  const Value value = ParseYaml("a:\nb: 1\n", "x");
  EXPECT_EQ(value.Find("a"), nullptr);
  EXPECT_EQ(value.Find("c"), nullptr);
  ASSERT_NE(value.Find("b"), nullptr);
  EXPECT_EQ(value.Find("b")->AsInt(), 1);
}

TEST(Value, FailNamesWhereItWasRead) {
  EXPECT_EQ(InputErrorOf([] { Board().At("quoted").Fail("odd", "why", "remedy"); }),
            "odd, board.yaml line 4, key quoted: why; remedy");
  EXPECT_EQ(Value(1).Where(), "");
}

TEST(Value, NumbersMakesAnArrayOfAnyRange) {
  EXPECT_EQ(Value::Numbers(std::vector<double>{1.5, 2.0}).AsDoubles(2),
            (std::vector<double>{1.5, 2.0}));
}

}  // namespace
}  // namespace calibrato
