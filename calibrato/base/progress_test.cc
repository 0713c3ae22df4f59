#include "calibrato/base/progress.h"

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <vector>

namespace calibrato {
namespace {

// What `call`, in a child process, writes to its stderr, which is `write_end`. Reads while it runs:
// a full buffer would stop the child.
template <typename Call>
std::string StderrOf(int read_end, int write_end, const Call& call) {
  const pid_t child = fork();
  if (child < 0) return "no child";
  if (child == 0) {
    dup2(write_end, STDERR_FILENO);
    call();
    _exit(0);
  }
  close(write_end);
  std::string text;
  char block[4096];
  ssize_t count = 0;
  while ((count = read(read_end, block, sizeof block)) > 0) {
    text.append(block, static_cast<size_t>(count));
  }
  close(read_end);
  int status = 0;
  waitpid(child, &status, 0);
  return status == 0 ? text : "the child failed";
}

// The same where stderr is a terminal of 60 columns.
template <typename Call>
std::string OnTerminal(const Call& call) {
  int master = -1;
  int slave = -1;
  winsize size{};
  size.ws_row = 24;
  size.ws_col = 60;
  if (openpty(&master, &slave, nullptr, nullptr, &size) != 0) return "no terminal";
  return StderrOf(master, slave, call);
}

TEST(Progress, DrawsOnATerminalAndClearsItsLineAtTheEnd) {
  const std::string text = OnTerminal([] {
    Progress progress("detecting", 4);
    progress.Advance(2, "rms 0.21");
  });
  EXPECT_NE(text.find("\rdetecting  ["), std::string::npos) << text;
  EXPECT_NE(text.find(" 50 %  2/4"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("\r\033[K")) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_LT(text.find("\033[K"), 61U) << "the line would wrap: " << text;
}

TEST(Progress, RedrawsAtMostTenTimesASecond) {
  const auto start = std::chrono::steady_clock::now();
  const std::string text = OnTerminal([] {
    Progress progress("x", 50);
    for (int i = 0; i < 50; ++i) progress.Advance();
  });
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  int num_draws = 0;
  for (const char c : text)
    num_draws += c == '[' ? 1 : 0;  // bar and escape: two a draw, one at the end
  EXPECT_LE((num_draws - 1) / 2, 1 + static_cast<int>(elapsed.count() * 10.0));
}

TEST(Progress, CountsTheAdvancesOfAllThreads) {
  const std::string text = OnTerminal([] {
    Progress progress("x", 4001);
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] {
        for (int j = 0; j < 1000; ++j) progress.Advance();
      });
    }
    for (std::thread& thread : threads) thread.join();
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    progress.Advance();
  });
  EXPECT_NE(text.find("4001/4001"), std::string::npos) << text;
}

TEST(Progress, SaysNothingWhenSilenced) {
  EXPECT_EQ(OnTerminal([] {
              Progress progress("x", 2);
              Progress::Silence();
              progress.Advance();
            }),
            "");
}

TEST(Progress, SaysNothingWhereStderrIsNoTerminal) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  EXPECT_EQ(StderrOf(ends[0], ends[1],
                     [] {
                       Progress progress("x", 2);
                       progress.Advance();
                     }),
            "");
}

}  // namespace
}  // namespace calibrato
