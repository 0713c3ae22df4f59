#include "calibrato/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <exception>
#include <memory>
#include <mutex>

namespace calibrato {
namespace {

std::atomic<int> requested_threads{0};

// True on a thread that runs a body: a loop started there runs serially. It could not gain much,
// and a thread that waits for an inner loop would otherwise pick up another body of the outer one,
// under the locks and on top of the thread-local state of the first.
thread_local bool inside_body = false;

class InsideBody {
 public:
  InsideBody() : before_(inside_body) { inside_body = true; }
  ~InsideBody() { inside_body = before_; }
  InsideBody(const InsideBody&) = delete;
  InsideBody& operator=(const InsideBody&) = delete;

 private:
  bool before_;
};

struct Pool {
  explicit Pool(int num_threads)
      : num_threads(num_threads),
        limit(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(num_threads)),
        arena(num_threads) {}
  int num_threads;
  tbb::global_control limit;  // lets the arena have more threads than there are cores
  tbb::task_arena arena;
};

// Shared, since a loop of another thread may still run in the pool that SetNumThreads replaces.
std::shared_ptr<Pool> CurrentPool() {
  static std::mutex mutex;
  // Never destroyed: the order in which static objects go would matter to TBB.
  static auto& pool = *new std::shared_ptr<Pool>();
  const std::lock_guard lock(mutex);
  const int num_threads = NumThreads();
  if (!pool || pool->num_threads != num_threads) {
    pool.reset();
    pool = std::make_shared<Pool>(num_threads);
  }
  return pool;
}

class FirstError {
 public:
  void Record(size_t index, std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (error_ && index_ <= index) return;
    index_ = index;
    error_ = std::move(error);
  }
  void RethrowIfAny() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  size_t index_ = 0;
  std::exception_ptr error_;
};

}  // namespace

void SetNumThreads(int num_threads) {
  assert(num_threads >= 0);
  requested_threads = std::max(0, num_threads);
}

int NumThreads() {
  const int requested = requested_threads;
  return requested > 0 ? requested : std::max(1, tbb::info::default_concurrency());
}

void ParallelFor(size_t n, const std::function<void(size_t)>& body) {
  FirstError first_error;
  const auto run = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      try {
        body(i);
      } catch (...) {
        first_error.Record(i, std::current_exception());
      }
    }
  };
  if (n <= 1 || inside_body || NumThreads() == 1) {
    run(0, n);
  } else {
    const std::shared_ptr<Pool> pool = CurrentPool();
    pool->arena.execute([&] {
      tbb::parallel_for(tbb::blocked_range<size_t>(0, n), [&](const auto& range) {
        const InsideBody inside;
        run(range.begin(), range.end());
      });
    });
  }
  first_error.RethrowIfAny();
}

}  // namespace calibrato
