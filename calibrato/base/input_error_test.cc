#include "calibrato/base/input_error.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

TEST(InputError, JoinsItsFourParts) {
  EXPECT_STREQ(InputError({"cannot read image", "left03.jpg", "truncated", "copy it again"}).what(),
               "cannot read image, left03.jpg: truncated; copy it again");
}

TEST(InputError, LeavesOutEmptyPartsWithTheirSeparators) {
  EXPECT_STREQ(InputError({"what", "", "", ""}).what(), "what");
  EXPECT_STREQ(InputError({"what", "where", "", ""}).what(), "what, where");
  EXPECT_STREQ(InputError({"what", "", "why", ""}).what(), "what: why");
  EXPECT_STREQ(InputError({"what", "", "", "remedy"}).what(), "what; remedy");
  EXPECT_STREQ(InputError({"", "where", "why", ""}).what(), "where: why");
}

TEST(InputError, IsOneLineWithoutControlCharactersWhateverItQuotes) {
  EXPECT_STREQ(InputError({"a\nb", "c\r\n d", "\x1b[31me\x7f\t\n", "\n"}).what(),
               "a b, c d: [31me");
}

TEST(InputError, KeepsUtf8) {
  EXPECT_STREQ(InputError({"pr\xc3\xa4zise", "", "", ""}).what(), "pr\xc3\xa4zise");
}

}  // namespace
}  // namespace calibrato
