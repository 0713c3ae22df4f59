#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/base/rng.h"
#include "calibrato/base/value.h"

namespace calibrato {
namespace {

TEST(ParseYaml, LetsTheAccessorDecideTheTypeOfUnquotedText) {
  const Value value = ParseYaml("a: 1e-3\nb: 5\nc: true\nd: yes\ne: .inf\nf: .nan\ng: '5'\n", "f");
  EXPECT_EQ(value.At("a").AsDouble(), 1e-3);
  EXPECT_EQ(value.At("a").AsString(), "1e-3");
  EXPECT_EQ(value.At("b").AsInt(), 5);
  EXPECT_EQ(value.At("b").AsDouble(), 5.0);
  EXPECT_EQ(value.At("b").AsString(), "5");
  EXPECT_TRUE(value.At("c").AsBool());
  EXPECT_THROW(value.At("d").AsBool(), InputError);
  EXPECT_THROW(value.At("e").AsDouble(), InputError);
  EXPECT_THROW(value.At("f").AsDouble(), InputError);
  EXPECT_EQ(value.At("g").AsString(), "5");
  EXPECT_THROW(value.At("g").AsInt(), InputError);
  EXPECT_THROW(value.At("g").AsDouble(), InputError);
  EXPECT_EQ(ParseYaml("!!str 5", "f").AsString(), "5");
  EXPECT_THROW(ParseYaml("!!str 5", "f").AsInt(), InputError);
}

TEST(ParseYaml, KnowsLinesAndKeys) {
  const Value value = ParseYaml(
      "# comment\r\ncam0:\r\n  intrinsics: [1,\r\n    2]\r\n  list:\r\n  - a\r\n  - b: 1\r\n", "f");
  EXPECT_EQ(value.At("cam0").Where(), "f line 2, key cam0");
  EXPECT_EQ(value.At("cam0").At("intrinsics").elements()[1].Where(),
            "f line 4, key cam0.intrinsics[1]");
  EXPECT_EQ(value.At("cam0").At("list").elements()[1].At("b").Where(),
            "f line 7, key cam0.list[1].b");
}

TEST(ParseYaml, SyntaxErrorsNameLineAndColumn) {
  const std::string message = InputErrorOf([] { ParseYaml("a: 1\nb: [1, 2\nc: 3\n", "b.yaml"); });
  EXPECT_TRUE(message.starts_with("cannot read YAML, b.yaml line ")) << message;
  EXPECT_NE(message.find(", column "), std::string::npos) << message;
  for (const char* text :
       {"a: b: c", "\"open", "- a\nb: 1", "a: *none", "\tx: 1\n y", "? [a]\n: 1", "{a: 1}: 2"}) {
    EXPECT_THROW(ParseYaml(text, "f"), InputError) << text;
  }
}

TEST(ParseYaml, RefusesDuplicateKeysDocumentsMergeKeysAndBinary) {
  EXPECT_EQ(InputErrorOf([] { ParseYaml("x: {a: 1}\ny: 1\nx: 3\n", "f"); }),
            "duplicate key x, f line 3: it stands earlier in the same mapping; remove one of the "
            "two");
  EXPECT_NE(InputErrorOf([] { ParseYaml("a: 1\n---\nb: 2\n", "f"); }).find("second document"),
            std::string::npos);
  EXPECT_NE(InputErrorOf([] { ParseYaml("a: &a {x: 1}\nb:\n  <<: *a\n", "f"); }).find("merge keys"),
            std::string::npos);
  EXPECT_NE(InputErrorOf([] { ParseYaml(std::string("a: 1\nb\0: 2", 11), "f"); }).find("line 2"),
            std::string::npos);
  EXPECT_NO_THROW(ParseYaml("%YAML 1.2\n---\na: 1\n...\n", "f"));
}

TEST(ParseYaml, ExpandsAliasesAndKeepsWhereTheirTextStands) {
  const Value value = ParseYaml("a: &size [640, 480]\nb: *size\nc: [*size, &n 3, *n]\n", "f");
  EXPECT_EQ(value.At("b").AsDoubles(2), (std::vector<double>{640, 480}));
  EXPECT_EQ(value.At("c").elements()[0].AsDoubles(2), (std::vector<double>{640, 480}));
  EXPECT_EQ(value.At("c").elements()[2].AsInt(), 3);
  EXPECT_EQ(value.At("b").Where(), "f line 1, key a");
}

TEST(ParseYaml, SurvivesAliasBombs) {
  std::string values = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  std::string depth = "a0: &a0 [x]\n";
  std::string text = "a0: &a0 \"" + std::string(1'000'000, 't') + "\"\nb: [";
  for (int i = 1; i < 200; ++i) {
    std::string before = "*a";
    before += std::to_string(i - 1);
    std::string begin = "a";
    begin.append(std::to_string(i)).append(": &a").append(std::to_string(i));
    begin.append(" [").append(before);
    values += begin;
    for (int j = 1; j < 10; ++j) values += ", " + before;
    values += "]\n";
    depth += begin + "]\n";
    text += "*a0, *a0, ";
  }
  text += "x]\n";
  EXPECT_NE(InputErrorOf([&] { ParseYaml(values, "f"); }).find("too many values"),
            std::string::npos);
  EXPECT_NE(InputErrorOf([&] { ParseYaml(depth, "f"); }).find("too many levels"),
            std::string::npos);
  EXPECT_NE(InputErrorOf([&] { ParseYaml(text, "f"); }).find("too much text"), std::string::npos);
  EXPECT_NE(InputErrorOf([] { ParseYaml("&a [*a]", "f"); }).find("inside what it refers to"),
            std::string::npos);
}

TEST(ParseYaml, CountsTheCopiesThatAnchorsKeep) {
  // 60 anchors around the same 20,000 values would keep 1.2 million.
  std::string text;
  for (int i = 0; i < 60; ++i) text.append("&a").append(std::to_string(i)).append(" [");
  for (int i = 0; i < 20000; ++i) text += "x, ";
  text += std::string(60, ']');
  EXPECT_NE(InputErrorOf([&] { ParseYaml(text, "f"); }).find("too many values"), std::string::npos);
}

TEST(ParseYaml, SurvivesHostileNesting) {
  EXPECT_NE(InputErrorOf([] { ParseYaml(std::string(20000, '['), "f"); }), "");
  std::string block;
  for (size_t i = 0; i < 150; ++i) block += std::string(i, ' ') + "a:\n";
  EXPECT_NE(InputErrorOf([&] { ParseYaml(block, "f"); }).find("too many levels, f line 101"),
            std::string::npos)
      << InputErrorOf([&] { ParseYaml(block, "f"); });
}

TEST(ToYaml, WritesAsKalibrDoes) {
  Value camera;
  camera.Set("camera_model", "pinhole").Set("rostopic", "/cam0/image_raw");
  camera.Set("intrinsics", Value::Numbers(std::vector<double>{461.0, 0.00001}));
  camera.Set("resolution", Value::Array().Append(752).Append(480));
  camera.Set("T_cn_cnm1", Value::Array()
                              .Append(Value::Numbers(std::vector<double>{1, 0}))
                              .Append(Value::Numbers(std::vector<double>{0, 1e22})));
  camera.Set("cam_overlaps", Value::Array()).Set("extra", Value::Object()).Set("none", Value());
  EXPECT_EQ(ToYaml(Value::Object().Set("cam0", camera)),
            "cam0:\n"
            "  camera_model: pinhole\n"
            "  rostopic: /cam0/image_raw\n"
            "  intrinsics: [461.0, 1.0e-05]\n"
            "  resolution: [752, 480]\n"
            "  T_cn_cnm1:\n"
            "    - [1.0, 0.0]\n"
            "    - [0.0, 1.0e+22]\n"
            "  cam_overlaps: []\n"
            "  extra: {}\n"
            "  none: null\n");
}

TEST(ToYaml, WritesArraysOfMappings) {
  Value loops = Value::Array();
  loops.Append(
      Value::Object().Set("duration_s", 5.0).Set("coefficients", Value::Array().Append(1)));
  loops.Append(Value::Array().Append(Value::Object().Set("a", 1).Set("b", 2)));
  const std::string text = ToYaml(Value::Object().Set("loops", loops));
  EXPECT_EQ(text,
            "loops:\n"
            "  - duration_s: 5.0\n"
            "    coefficients: [1]\n"
            "  - - a: 1\n"
            "      b: 2\n");
  EXPECT_EQ(ToJsonLine(ParseYaml(text, "f")),
            "{\"loops\": [{\"duration_s\": 5, \"coefficients\": [1]}, [{\"a\": 1, \"b\": 2}]]}");
}

TEST(ToYaml, QuotesTextThatWouldReadBackAsSomethingElse) {
  std::vector<std::string> texts = {"",          " ",    "a: b",     "a #b",
                                    "#a",        "- a",  "-",        "?",
                                    "5",         "1e3",  "0x1f",     "true",
                                    "No",        "null", "~",        "y",
                                    "on",        ".inf", "[a]",      "{a}",
                                    "a,b",       "a]",   "'a'",      "\"a\"",
                                    "a\nb",      "a\\b", "*a",       "&a",
                                    "!a",        "|",    ">",        "%a",
                                    "@a",        "`a`",  "a:",       ":a",
                                    "---",       "...",  "a ",       " a",
                                    "a\tb",      "1:30", "<<",       "=",
                                    "plain",     "a b",  "a-b",      "/a/b.c",
                                    "\xc3\xa4",  "\x7f", "\x01\x1f", "\xe2\x80\xa8",
                                    "2020-01-01"};
  for (const std::string& text : texts) {
    Value value = Value::Object().Set(text, text);
    value.Set("list", Value::Array().Append(text).Append(1));
    const Value back = ParseYaml(ToYaml(value), "f");
    EXPECT_EQ(back.At(text).AsString(), text) << ToYaml(value);
    EXPECT_EQ(back.At("list").elements().at(0).AsString(), text) << ToYaml(value);
    EXPECT_EQ(back.At("list").size(), 2U) << ToYaml(value);
    // It is still text, not a number, flag or nothing.
    EXPECT_TRUE(ToJsonLine(back.At(text)).starts_with('"')) << ToYaml(value);
  }
  for (const char* text : {"plain", "a b", "/a/b.c", "pinhole-radtan"}) {
    EXPECT_EQ(ToYaml(Value(text)), std::string(text) + "\n");
  }
  for (const char* text : {"true", "No", "5", "y", "on", "2020-01-01", "a: b", ""}) {
    EXPECT_TRUE(ToYaml(Value(text)).starts_with('"')) << text;
  }
}

TEST(ToYaml, KeepsWhatWasReadFromYaml) {
  const std::string text =
      "a: 1e-3\n"
      "b: [5, true, \"5\", \"true\", word]\n"
      "c:\n"
      "  - [1, 2]\n"
      "  - [3, 4]\n";
  EXPECT_EQ(ToYaml(ParseYaml(text, "f")), text);
}

TEST(ToYaml, NumbersReadBackToTheSameBits) {
  Rng rng(1);
  std::vector<double> numbers = {0.0, -0.0, 5e-324, 1.7976931348623157e308};
  while (numbers.size() < 50000) {
    const double any = std::bit_cast<double>(rng.NextBits());
    if (std::isfinite(any)) numbers.push_back(any);
    numbers.push_back(rng.Normal());
  }
  const std::string text = ToYaml(Value::Numbers(numbers));
  const std::vector<double> back = ParseYaml(text, "f").AsDoubles(numbers.size());
  for (size_t i = 0; i < numbers.size(); ++i) {
    ASSERT_EQ(std::bit_cast<uint64_t>(back[i]), std::bit_cast<uint64_t>(numbers[i])) << numbers[i];
  }
  for (const double x : {1.0, -0.0, 1e-5, 1e300, 123456789.0}) {
    EXPECT_NE(ToYaml(x).find('.'), std::string::npos) << ToYaml(x);
  }
}

TEST(ToYaml, WritesWhatIsNotFiniteAsNull) {
  EXPECT_EQ(ToYaml(Value::Numbers(std::vector<double>{std::nan(""), 1.0})), "[null, 1.0]\n");
}

}  // namespace
}  // namespace calibrato
