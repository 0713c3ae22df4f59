#include "calibrato/base/scalar_text.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "calibrato/base/rng.h"
#include "calibrato/base/value.h"

namespace calibrato {
namespace {

TEST(ParseWholeNumber, TakesWholeNumbersOnly) {
  EXPECT_EQ(ParseWholeNumber("12"), 12);
  EXPECT_EQ(ParseWholeNumber("-3"), -3);
  EXPECT_EQ(ParseWholeNumber("+7"), 7);
  EXPECT_EQ(ParseWholeNumber("9223372036854775807"), std::numeric_limits<int64_t>::max());
  for (const char* text :
       {"", "+", "-", "1.0", "1e3", "0x10", " 1", "1 ", "+-1", "six", "9223372036854775808"}) {
    EXPECT_EQ(ParseWholeNumber(text), std::nullopt) << text;
  }
}

TEST(ParseDecimal, TakesFiniteDecimalsOnly) {
  EXPECT_EQ(ParseDecimal("1e-3"), 1e-3);
  EXPECT_EQ(ParseDecimal("-0.25"), -0.25);
  EXPECT_EQ(ParseDecimal("+.5"), 0.5);
  EXPECT_EQ(ParseDecimal("1."), 1.0);
  EXPECT_EQ(ParseDecimal("7"), 7.0);
  for (const char* text : {"", ".", "e5", "inf", "-inf", ".inf", "nan", ".nan", "NaN", "1e999",
                           "0x1p3", "1,5", "0.06 m", "1.5.2", "+-1"}) {
    EXPECT_EQ(ParseDecimal(text), std::nullopt) << text;
  }
}

TEST(FormatNumber, IsTheShortestThatReadsBack) {
  EXPECT_EQ(FormatNumber(0.1), "0.1");
  EXPECT_EQ(FormatNumber(-2.5), "-2.5");
  EXPECT_EQ(FormatNumber(3.0), "3");
  EXPECT_EQ(FormatNumber(1e-5), "1e-05");
  EXPECT_EQ(FormatNumber(1.0 / 3.0), "0.3333333333333333");
  EXPECT_EQ(FormatNumber(0.0), "0");
  EXPECT_EQ(FormatNumber(-0.0), "-0.0");
  EXPECT_EQ(FormatNumber(std::nan("")), "null");
  EXPECT_EQ(FormatNumber(-std::numeric_limits<double>::infinity()), "null");
}

TEST(FormatNumber, ReadsBackToTheSameBitsByTheCLibrary) {
  Rng rng(1);
  for (int i = 0; i < 200000; ++i) {
    const double x = std::bit_cast<double>(rng.NextBits());
    if (!std::isfinite(x)) continue;
    const double back = std::strtod(FormatNumber(x).c_str(), nullptr);
    ASSERT_EQ(std::bit_cast<uint64_t>(back), std::bit_cast<uint64_t>(x)) << FormatNumber(x);
  }
}

TEST(QuoteText, EscapesWhatWouldEndTheTextOrTheLine) {
  EXPECT_EQ(QuoteText("a\"b\\c\nd"), R"("a\"b\\c\nd")");
  EXPECT_EQ(QuoteText(std::string("\x01", 1)), "\"\\u0001\"");
  EXPECT_EQ(QuoteText("\xc3\xa4"), "\"\xc3\xa4\"");
  EXPECT_EQ(QuoteText("\xff"), "\"\xef\xbf\xbd\"");
}

}  // namespace
}  // namespace calibrato
