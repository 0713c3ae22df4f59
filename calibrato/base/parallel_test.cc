#include "calibrato/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

namespace calibrato {
namespace {

class ParallelForWithThreads : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { SetNumThreads(GetParam()); }
  void TearDown() override { SetNumThreads(0); }
};

INSTANTIATE_TEST_SUITE_P(Threads, ParallelForWithThreads, testing::Values(0, 1, 2, 4, 7));

TEST_P(ParallelForWithThreads, RunsEveryIndexOnce) {
  for (const size_t n : {0, 1, 2, 3, 1000}) {
    std::vector<std::atomic<int>> counts(n);
    ParallelFor(n, [&](size_t i) { ++counts[i]; });
    for (const auto& count : counts) ASSERT_EQ(count, 1);
  }
}

TEST_P(ParallelForWithThreads, MapKeepsTheOrderSoThatSumsAreTheSame) {
  const std::function<double(size_t)> term = [](size_t i) {
    return std::sin(static_cast<double>(i)) * 1e3;
  };
  double serial = 0.0;
  for (size_t i = 0; i < 5000; ++i) serial += term(i);
  double sum = 0.0;
  for (const double x : ParallelMap<double>(5000, term)) sum += x;
  EXPECT_EQ(sum, serial);
}

TEST_P(ParallelForWithThreads, RethrowsTheLowestIndexAfterAllHaveRun) {
  for (int repetition = 0; repetition < 20; ++repetition) {
    std::atomic<int> num_run{0};
    try {
      ParallelFor(200, [&](size_t i) {
        ++num_run;
        // The lowest of those that throw comes last in time.
        if (i == 30) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (i % 50 == 30) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "30");
    }
    EXPECT_EQ(num_run, 200);
  }
}

TEST_P(ParallelForWithThreads, NestedLoopsStayOnTheirBodysThread) {
  std::atomic<int> num_run{0};
  std::atomic<int> num_elsewhere{0};
  // Two outer bodies leave threads idle, which would help with inner ones if they could.
  ParallelFor(2, [&](size_t) {
    const std::thread::id thread = std::this_thread::get_id();
    ParallelFor(16, [&](size_t) {
      ParallelFor(2, [&](size_t) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        ++num_run;
        if (std::this_thread::get_id() != thread) ++num_elsewhere;
      });
    });
  });
  EXPECT_EQ(num_run, 2 * 16 * 2);
  EXPECT_EQ(num_elsewhere, 0);
}

TEST_P(ParallelForWithThreads, NestedLoopsUnderALockDoNotDeadlock) {
  std::atomic<int> num_run{0};
  std::mutex one_at_a_time;
  ParallelFor(64, [&](size_t) {
    const std::lock_guard lock(one_at_a_time);  // taken twice if another body is begun in here
    ParallelFor(16, [&](size_t) { ++num_run; });
  });
  EXPECT_EQ(num_run, 64 * 16);
}

TEST_P(ParallelForWithThreads, NestedErrorsReachTheOutside) {
  EXPECT_THROW(ParallelFor(8,
                           [](size_t i) {
                             ParallelFor(8, [i](size_t j) {
                               if (i == 5 && j == 5) throw std::logic_error("inner");
                             });
                           }),
               std::logic_error);
}

TEST(ParallelFor, RunsOnTheCallerInOrderWithOneThread) {
  SetNumThreads(1);
  std::vector<size_t> order;
  const std::thread::id caller = std::this_thread::get_id();
  ParallelFor(100, [&](size_t i) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    order.push_back(i);
  });
  SetNumThreads(0);
  for (size_t i = 0; i < 100; ++i) EXPECT_EQ(order[i], i);
}

TEST(ParallelFor, UsesAsManyThreadsAsWereAskedForAndNoMore) {
  SetNumThreads(3);
  EXPECT_EQ(NumThreads(), 3);
  std::mutex mutex;
  std::set<std::thread::id> threads;
  ParallelFor(60, [&](size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const std::lock_guard lock(mutex);
    threads.insert(std::this_thread::get_id());
  });
  SetNumThreads(0);
  EXPECT_GT(threads.size(), 1U);
  EXPECT_LE(threads.size(), 3U);
}

TEST(NumThreads, IsAtLeastOneByDefault) {
  SetNumThreads(0);
  EXPECT_GE(NumThreads(), 1);
}

}  // namespace
}  // namespace calibrato
