#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/base/rng.h"
#include "calibrato/base/value.h"

namespace calibrato {
namespace {

TEST(ParseJson, ReadsEveryType) {
  const Value value = ParseJson(
      R"({"a": null, "b": true, "i": -3, "d": 2.5, "s": "x\ny", "l": [1, [2]], "o": {}})", "f");
  EXPECT_TRUE(value.At("a").IsNull());
  EXPECT_TRUE(value.At("b").AsBool());
  EXPECT_EQ(value.At("i").AsInt(), -3);
  EXPECT_EQ(value.At("d").AsDouble(), 2.5);
  EXPECT_EQ(value.At("s").AsString(), "x\ny");
  EXPECT_EQ(value.At("l").size(), 2U);
  EXPECT_TRUE(value.At("o").IsObject());
  EXPECT_EQ(ParseJson("18446744073709551615", "f").AsDouble(), 18446744073709551615.0);
  EXPECT_EQ(ParseJson("9223372036854775807", "f").AsInt(), std::numeric_limits<int64_t>::max());
}

TEST(ParseJson, KnowsTheLineOfEveryValueWhateverFollowsIt) {
  const Value value =
      ParseJson("{\n\"a\": 1\n,\"b\": [\n10\n,\n\n20], \"c\"\n:\n\"x\"\n}", "f.json");
  EXPECT_EQ(value.At("a").Where(), "f.json line 2, key a");
  EXPECT_EQ(value.At("b").Where(), "f.json line 3, key b");
  EXPECT_EQ(value.At("b").elements()[0].Where(), "f.json line 4, key b[0]");
  EXPECT_EQ(value.At("b").elements()[1].Where(), "f.json line 7, key b[1]");
  EXPECT_EQ(value.At("c").Where(), "f.json line 7, key c");
}

TEST(ParseJson, SyntaxErrorsNameLineAndColumn) {
  const std::string message = InputErrorOf([] { ParseJson("{\n  \"a\": 1,\n  }", "f.json"); });
  EXPECT_TRUE(message.starts_with("cannot read JSON, f.json line 3, column 3: syntax error"))
      << message;
}

TEST(ParseJson, IsStrict) {
  for (const char* text : {"", "{", "[1,]", "{\"a\" 1}", "'a'", "nan", "[1] 2", "// x\n1", "01",
                           "+1", ".5", "\"\xff\"", "\"a\nb\"", "1e999", "{\"a\":1,\"a\":2}"}) {
    EXPECT_THROW(ParseJson(text, "f"), InputError) << text;
  }
}

TEST(ParseJson, SurvivesHostileNesting) {
  EXPECT_NE(InputErrorOf([] { ParseJson(std::string(1000000, '['), "f"); }).find("too many levels"),
            std::string::npos);
}

Value Sample() {
  Value value;
  value.Set("kind", "camera").Set("num_views", 13).Set("ok", true).Set("none", Value());
  value.Set("resolution", Value::Array().Append(640).Append(480));
  value.Set("matrix", Value::Array()
                          .Append(Value::Numbers(std::vector<double>{1.0, 0.5}))
                          .Append(Value::Numbers(std::vector<double>{0.5, 2.0})));
  value.Set("findings", Value::Array()).Set("information", Value::Object());
  return value;
}

TEST(ToJson, IndentsByTwoWithArraysOfScalarsOnOneLine) {
  EXPECT_EQ(ToJson(Sample()),
            "{\n"
            "  \"kind\": \"camera\",\n"
            "  \"num_views\": 13,\n"
            "  \"ok\": true,\n"
            "  \"none\": null,\n"
            "  \"resolution\": [640, 480],\n"
            "  \"matrix\": [\n"
            "    [1, 0.5],\n"
            "    [0.5, 2]\n"
            "  ],\n"
            "  \"findings\": [],\n"
            "  \"information\": {}\n"
            "}\n");
}

TEST(ToJsonLine, IsTheSameOnOneLine) {
  EXPECT_EQ(ToJsonLine(Sample()),
            "{\"kind\": \"camera\", \"num_views\": 13, \"ok\": true, \"none\": null, "
            "\"resolution\": [640, 480], \"matrix\": [[1, 0.5], [0.5, 2]], \"findings\": [], "
            "\"information\": {}}");
}

TEST(ToJson, ReadsBackToTheSame) {
  EXPECT_EQ(ToJson(ParseJson(ToJson(Sample()), "f")), ToJson(Sample()));
}

TEST(ToJson, WritesWhatIsNotFiniteAsNull) {
  EXPECT_EQ(ToJsonLine(Value::Numbers(
                std::vector<double>{std::nan(""), std::numeric_limits<double>::infinity(), 1.0})),
            "[null, null, 1]");
}

TEST(ToJson, NumbersReadBackToTheSameBits) {
  Rng rng(1);
  std::vector<double> numbers = {0.0, -0.0, 5e-324, 1.7976931348623157e308, 9007199254740993.0};
  while (numbers.size() < 100000) {
    const double any = std::bit_cast<double>(rng.NextBits());
    if (std::isfinite(any)) numbers.push_back(any);
    numbers.push_back(rng.Normal(0.0, 1000.0));
    numbers.push_back(std::round(rng.Normal(0.0, 1e17)));
  }
  const std::vector<double> back =
      ParseJson(ToJson(Value::Numbers(numbers)), "f").AsDoubles(numbers.size());
  for (size_t i = 0; i < numbers.size(); ++i) {
    ASSERT_EQ(std::bit_cast<uint64_t>(back[i]), std::bit_cast<uint64_t>(numbers[i])) << numbers[i];
  }
}

TEST(ToJson, GivesUnquotedYamlTheTypeThatItLooksLike) {
  EXPECT_EQ(ToJsonLine(ParseYaml("[1, +2, .5, 1e-3, -0, true, no, '1', text, ~]", "f")),
            "[1, 2, 0.5, 0.001, -0.0, true, \"no\", \"1\", \"text\", null]");
}

}  // namespace
}  // namespace calibrato
