#include "calibrato/base/temporary_file.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <string>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

class TemporaryFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name =
        (std::filesystem::temp_directory_path() / "calibrato-temporary-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }

  std::filesystem::path folder_;
};

TEST_F(TemporaryFileTest, HasItsNameOnlyWhenRenamed) {
  WriteFileAtomically(Path("kept"), "old");
  { const TemporaryFile dropped(Path("kept"), "new"); }
  EXPECT_EQ(ReadFile(Path("kept")), "old");
  EXPECT_EQ(ListFiles(folder_.string()).size(), 1U);
  TemporaryFile renamed(Path("kept"), "new");
  EXPECT_EQ(ReadFile(Path("kept")), "old");
  renamed.Rename();
  EXPECT_EQ(ReadFile(Path("kept")), "new");
  EXPECT_EQ(ListFiles(folder_.string()).size(), 1U);
}

TEST_F(TemporaryFileTest, ItsPlaceIsCheckedBeforehand) {
  EXPECT_NO_THROW(CheckFileCanBeWritten(Path("new")));
  EXPECT_FALSE(std::filesystem::exists(Path("new")));
  WriteFileAtomically(Path("old"), "old");
  EXPECT_NO_THROW(CheckFileCanBeWritten(Path("old")));
  EXPECT_EQ(ReadFile(Path("old")), "old");
  EXPECT_THROW(CheckFileCanBeWritten(Path("nowhere/new")), InputError);
  EXPECT_THROW(CheckFileCanBeWritten(Path("old/new")), InputError);
  EXPECT_THROW(CheckFileCanBeWritten(folder_.string()), InputError);
  EXPECT_THROW(CheckFileCanBeWritten(Path("new/")), InputError);
  EXPECT_THROW(CheckFileCanBeWritten("/dev/null"), InputError);
  EXPECT_THROW(CheckFileCanBeWritten(""), InputError);
}

}  // namespace
}  // namespace calibrato
