#include "calibrato/recording/file_kind.h"

#include <gtest/gtest.h>

#include <string>

#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using namespace std::string_literals;

FileKind KindOf(const std::string& bytes) {
  const TestFolder folder;
  return KindOfFile(folder.Write("file", bytes));
}

TEST(KindOfFile, IsToldByTheFirstBytes) {
  EXPECT_EQ(KindOf("#ROSBAG V2.0\nand more"), FileKind::kRosbag1);
  EXPECT_EQ(KindOf("#ROSBAG V1.2\nand more"), FileKind::kOldRosbag1);
  EXPECT_EQ(KindOf("\x89MCAP0\r\n"), FileKind::kMcap);
  EXPECT_EQ(KindOf("SQLite format 3\0"s), FileKind::kSqlite);
  EXPECT_EQ(KindOf("\x28\xb5\x2f\xfd"), FileKind::kZstd);
  EXPECT_EQ(KindOf("RIFF....AVI LIST"), FileKind::kVideo);
  EXPECT_EQ(KindOf("RIFF....WAVEfmt "), FileKind::kOther);
  EXPECT_EQ(KindOf("\0\0\0\x18"
                   "ftypmp42"s),
            FileKind::kVideo);
  EXPECT_EQ(KindOf("timestamp,w_x"), FileKind::kOther);
}

// Whatever a file begins with may be all that it has.
TEST(KindOfFile, TakesFilesOfAnyLength) {
  for (const std::string& whole : {"#ROSBAG V2.0\n"s, "\x89MCAP0\r\n"s, "SQLite format 3\0"s,
                                   "\x28\xb5\x2f\xfd"s, "RIFF....AVI LIST"s,
                                   "\0\0\0\x18"
                                   "ftypmp42"s,
                                   "\x1a\x45\xdf\xa3"s}) {
    for (size_t size = 0; size < whole.size(); ++size) {
      EXPECT_NO_THROW(static_cast<void>(KindOf(whole.substr(0, size)))) << whole << " " << size;
    }
  }
}

}  // namespace
}  // namespace calibrato
