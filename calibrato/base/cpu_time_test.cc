#include "calibrato/base/cpu_time.h"

#include <gtest/gtest.h>

#include <thread>

namespace calibrato {
namespace {

// Computes until the thread has done so for a hundredth of a second.
void Work() {
  const double end = ThreadCpuSeconds() + 0.01;
  while (ThreadCpuSeconds() < end) {
  }
}

TEST(CpuTime, OfAThreadIsItsOwn) {
  const double thread = ThreadCpuSeconds();
  const double process = ProcessCpuSeconds();
  for (int k = 0; k < 5; ++k) std::thread(Work).join();
  EXPECT_LT(ThreadCpuSeconds() - thread, 0.04);
  EXPECT_GT(ProcessCpuSeconds() - process, 0.045);
  Work();
  EXPECT_GT(ThreadCpuSeconds() - thread, 0.0099);
}

}  // namespace
}  // namespace calibrato
