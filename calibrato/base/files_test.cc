#include "calibrato/base/files.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include "calibrato/base/input_error_testing.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;
using testing::Test;

class FilesTest : public Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "calibrato-files-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  void Write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }
  // Every path below the folder, sorted, joined by spaces.
  std::string Tree() const {
    std::set<std::string> paths;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      paths.insert(fs::relative(entry.path(), folder_).string());
    }
    std::string tree;
    for (const std::string& path : paths) tree += (tree.empty() ? "" : " ") + path;
    return tree;
  }

  fs::path folder_;
};

// Runs `call` where no file may grow beyond `max_bytes`, which fails as a full disk does.
// @return The message of its InputError.
template <typename Call>
std::string WithFileSizeLimit(rlim_t max_bytes, const Call& call) {
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{max_bytes, max_bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string message = InputErrorOf(call);
    const ssize_t written = write(ends[1], message.data(), message.size());
    _exit(written == static_cast<ssize_t>(message.size()) ? 0 : 1);
  }
  close(ends[1]);
  char message[4096];
  const ssize_t count = read(ends[0], message, sizeof message);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return count > 0 && status == 0 ? std::string(message, static_cast<size_t>(count)) : "";
}

using ReadFileTest = FilesTest;
using WriteFileTest = FilesTest;
using ListFilesTest = FilesTest;
using OutputFolderTest = FilesTest;

TEST_F(ReadFileTest, ReturnsEveryByte) {
  std::string content = "line\r\n";
  for (int i = 0; i < 200000; ++i) content += static_cast<char>(i % 256);
  Write("x", content);
  EXPECT_EQ(ReadFile(Path("x")), content);
  Write("empty", "");
  EXPECT_EQ(ReadFile(Path("empty")), "");
}

TEST_F(ReadFileTest, RefusesMoreThanTheLimitAndTakesExactlyTheLimit) {
  Write("x", "12345");
  EXPECT_EQ(ReadFile(Path("x"), 5), "12345");
  EXPECT_NE(InputErrorOf([&] { ReadFile(Path("x"), 4); }).find("larger than 4 bytes"),
            std::string::npos);
  EXPECT_THROW(ReadFile("/dev/zero", 1000), InputError);
}

TEST_F(ReadFileTest, SaysWhatIsWrongInPlainWords) {
  EXPECT_EQ(InputErrorOf([&] { ReadFile(Path("none.yaml")); }),
            "cannot read file, " + Path("none.yaml") +
                ": no such file or folder; check the spelling of the path");
  EXPECT_NE(InputErrorOf([&] { ReadFile(folder_); }).find("it is a folder"), std::string::npos);
  Write("x", "");
  EXPECT_NE(InputErrorOf([&] { ReadFile(Path("x/y")); }).find("a file, not a folder"),
            std::string::npos);
}

TEST_F(WriteFileTest, WritesAndReplaces) {
  WriteFileAtomically(Path("x"), "old and longer");
  WriteFileAtomically(Path("x"), "new");
  EXPECT_EQ(ReadFile(Path("x")), "new");
  EXPECT_EQ(Tree(), "x");
}

TEST_F(WriteFileTest, AReaderNeverSeesAPart) {
  const std::string first(200000, 'a');
  const std::string second(200000, 'b');
  WriteFileAtomically(Path("x"), first);
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int i = 0; i < 50; ++i) WriteFileAtomically(Path("x"), i % 2 == 0 ? second : first);
    done = true;
  });
  int num_partial = 0;
  while (!done) {
    const std::string seen = ReadFile(Path("x"));
    if (seen != first && seen != second) ++num_partial;
  }
  writer.join();
  EXPECT_EQ(num_partial, 0);
}

TEST_F(WriteFileTest, LeavesTheOldContentAndNoTemporaryWhenTheDiskIsFull) {
  Write("x", "old");
  const std::string message =
      WithFileSizeLimit(1000, [&] { WriteFileAtomically(Path("x"), std::string(100000, 'n')); });
  EXPECT_NE(message.find("cannot write file, " + Path("x")), std::string::npos) << message;
  EXPECT_NE(message.find("size limit"), std::string::npos) << message;
  EXPECT_EQ(ReadFile(Path("x")), "old");
  EXPECT_EQ(Tree(), "x");
}

TEST_F(WriteFileTest, RefusesFoldersAndDevices) {
  EXPECT_THROW(WriteFileAtomically(folder_, "x"), InputError);
  ASSERT_EQ(mkfifo(Path("pipe").c_str(), 0600), 0);
  EXPECT_NE(InputErrorOf([&] { WriteFileAtomically(Path("pipe"), "x"); }).find("device or a pipe"),
            std::string::npos);
  EXPECT_TRUE(fs::is_fifo(Path("pipe")));
  EXPECT_THROW(WriteFileAtomically(Path("none/x"), "x"), InputError);
  EXPECT_EQ(Tree(), "pipe");
}

TEST_F(WriteFileTest, FollowsASymbolicLinkAndKeepsIt) {
  Write("real", "old");
  fs::create_symlink("real", folder_ / "link");
  WriteFileAtomically(Path("link"), "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(ReadFile(Path("real")), "new");
}

TEST_F(ListFilesTest, MatchesAndSortsFilesOnly) {
  for (const char* name : {"left02.jpg", "left01.jpg", "left11.jpg", "left21.jpg", "right01.jpg",
                           "left01.png", ".hidden"}) {
    Write(name, "");
  }
  fs::create_directory(folder_ / "left03.jpg");
  EXPECT_EQ(ListFiles(folder_, "left[01]*.jpg"),
            (std::vector<std::string>{"left01.jpg", "left02.jpg", "left11.jpg"}));
  EXPECT_EQ(ListFiles(folder_).size(), 6U);
  EXPECT_TRUE(ListFiles(folder_, "*.bmp").empty());
}

TEST_F(ListFilesTest, NamesWhatIsNoFolder) {
  EXPECT_NE(InputErrorOf([&] { ListFiles(Path("none")); }).find("no such file or folder"),
            std::string::npos);
  Write("x", "");
  EXPECT_NE(InputErrorOf([&] { ListFiles(Path("x")); }).find("it is a file, not a folder"),
            std::string::npos);
}

TEST_F(OutputFolderTest, MakesNothingBeforeItIsCommitted) {
  OutputFolder out(Path("a/b"));
  out.Add("x", "1");
  EXPECT_EQ(Tree(), "");
  out.Commit();
  EXPECT_EQ(Tree(), "a a/b a/b/x");
}

TEST_F(OutputFolderTest, ReplacesOnlyItsOwnNamesInAnExistingFolder) {
  Write("kept", "kept");
  Write("x", "old");
  OutputFolder out(folder_);
  out.Add("x", "1");
  out.Add("policy/y", "2");
  out.Commit();
  EXPECT_EQ(Tree(), "kept policy policy/y x");
  EXPECT_EQ(ReadFile(Path("kept")), "kept");
  EXPECT_EQ(ReadFile(Path("x")), "1");
  EXPECT_EQ(ReadFile(Path("policy/y")), "2");
}

TEST_F(OutputFolderTest, TakesAwayWhatAnEarlierRunLeft) {
  Write("kept", "kept");
  Write("stale", "old");
  Write("x", "old");
  OutputFolder out(folder_);
  for (const char* name : {"stale", "x", "never-there"}) out.Remove(name);
  out.Add("x", "1");
  EXPECT_EQ(Tree(), "kept stale x");
  out.Commit();
  EXPECT_EQ(Tree(), "kept x");
  EXPECT_EQ(ReadFile(Path("x")), "1");
}

TEST_F(OutputFolderTest, TakesATrailingSlash) {
  OutputFolder out(Path("a/"));
  out.Add("x", "1");
  out.Commit();
  EXPECT_EQ(Tree(), "a a/x");
}

TEST_F(OutputFolderTest, LeavesNothingBehindWhenTheDiskIsFull) {
  const std::string message = WithFileSizeLimit(1000, [&] {
    OutputFolder out(Path("new/inner"));
    out.Add("a_small", "fits");
    out.Add("b/large", std::string(100000, 'n'));
    out.Commit();
  });
  EXPECT_NE(message.find("b/large"), std::string::npos) << message;
  EXPECT_EQ(Tree(), "");

  Write("a_small", "old");
  WithFileSizeLimit(1000, [&] {
    OutputFolder out(folder_);
    out.Add("a_small", "fits");
    out.Add("b_large", std::string(100000, 'n'));
    out.Commit();
  });
  EXPECT_EQ(Tree(), "a_small");
  EXPECT_EQ(ReadFile(Path("a_small")), "old");
}

TEST_F(OutputFolderTest, RefusesWhatCannotBecomeAFolder) {
  Write("file", "");
  fs::create_symlink("nowhere", folder_ / "dangling");
  EXPECT_NE(InputErrorOf([&] { OutputFolder out(Path("file")); }).find("is a file"),
            std::string::npos);
  EXPECT_NE(InputErrorOf([&] { OutputFolder out(Path("file/a/b")); }).find("not a folder"),
            std::string::npos);
  EXPECT_NE(InputErrorOf([&] { OutputFolder out(Path("dangling")); }).find("leads nowhere"),
            std::string::npos);
  EXPECT_NE(InputErrorOf([&] { OutputFolder out(""); }).find("empty"), std::string::npos);
  EXPECT_THROW(OutputFolder out(Path(std::string(300, 'x'))), InputError);
  EXPECT_EQ(Tree(), "dangling file");
}

TEST_F(OutputFolderTest, RefusesAFolderWithoutPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::create_directory(folder_ / "locked");
  fs::permissions(folder_ / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_NE(InputErrorOf([&] { OutputFolder out(Path("locked/new")); }).find("no permission"),
            std::string::npos);
}

}  // namespace
}  // namespace calibrato
