#include "calibrato/recording/text_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> LinesOf(const std::string& path) {
  TextLines lines(path);
  std::vector<std::string> all;
  while (const auto line = lines.Next()) {
    all.emplace_back(*line);
    EXPECT_EQ(lines.line_number(), static_cast<int64_t>(all.size()));
  }
  EXPECT_EQ(lines.Next(), std::nullopt);
  return all;
}

std::string ErrorOf(const std::string& path) {
  try {
    LinesOf(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

class TextLinesTest : public testing::Test {
 protected:
  TestFolder folder_;
};

TEST_F(TextLinesTest, EndsLinesAtLfAndCrlf) {
  EXPECT_THAT(LinesOf(folder_.Write("a", "one\r\ntwo\n\nfour")),
              ElementsAre("one", "two", "", "four"));
  EXPECT_THAT(LinesOf(folder_.Write("b", "one\n")), ElementsAre("one"));
  EXPECT_THAT(LinesOf(folder_.Write("c", "")), ElementsAre());
}

TEST_F(TextLinesTest, ReadsPlainAndGzipAlikeAcrossManyBlocks) {
  std::string text;
  std::vector<std::string> expected;
  for (int i = 0; i < 200'000; ++i) {
    expected.push_back("line " + std::to_string(i));
    text += expected.back() + "\n";
  }
  EXPECT_EQ(LinesOf(folder_.Write("plain", text)), expected);
  EXPECT_EQ(LinesOf(folder_.WriteGzip("packed", text)), expected);
}

TEST_F(TextLinesTest, TakesALineOfAlmostAMegabyteAndNoMore) {
  const std::string longest(TextLines::kMaxLineBytes, 'x');
  EXPECT_EQ(LinesOf(folder_.Write("long", longest + "\nend")).front(), longest);
  EXPECT_THAT(ErrorOf(folder_.Write("longer", "first\n" + std::string(4 << 20, 'x'))),
              HasSubstr("line 2 is longer than 1 MB"));
}

TEST_F(TextLinesTest, RefusesWhatIsNoText) {
  EXPECT_THAT(ErrorOf(folder_.Write("a", std::string("text\0text", 9))),
              HasSubstr("not a text file"));
}

TEST_F(TextLinesTest, RefusesATruncatedGzipWhereverItEnds) {
  std::string text;
  for (int i = 0; i < 20'000; ++i) text += std::to_string(i * 7919 % 104'729) + "\n";
  const std::string packed = Gzip(text);
  for (const size_t size : {packed.size() - 1, packed.size() - 9, packed.size() / 2, size_t{30}}) {
    EXPECT_THAT(ErrorOf(folder_.Write("cut.gz", packed.substr(0, size))), HasSubstr("truncated"))
        << size << " of " << packed.size();
  }
}

TEST_F(TextLinesTest, RefusesADamagedGzip) {
  std::string packed = Gzip("1,2,3\n4,5,6\n");
  packed[packed.size() - 6] ^= 1;  // of the checksum
  EXPECT_THAT(ErrorOf(folder_.Write("bad.gz", packed)), HasSubstr("damaged"));
}

TEST_F(TextLinesTest, SaysWhyAFileCannotBeRead) {
  EXPECT_THAT(ErrorOf(folder_.path() + "/absent.csv"),
              AllOf(HasSubstr("absent.csv"), HasSubstr("no such file")));
  EXPECT_THAT(ErrorOf(folder_.path()), HasSubstr("it is a folder"));
}

}  // namespace
}  // namespace calibrato
