#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace calibrato {

/// How many threads the parallel loops below may use. 0 means one per core (the default).
/// Set once, by the command line, before any loop runs. It changes times, never results.
void SetNumThreads(int num_threads);
int NumThreads();

/// Runs body(0), .., body(n - 1), in any order and on any thread; returns when all are done. Bodies
/// must not depend on each other. If bodies throw, the exception of the lowest index is rethrown
/// after all have run, so that errors too are the same for any number of threads.
/// Loops may nest: a loop inside a body runs serially, on that body's thread, unless the outer loop
/// has only one index.
void ParallelFor(size_t n, const std::function<void(size_t)>& body);

/// The results of function(0), .., function(n - 1) in the order of the index; reduce them in that
/// order and sums are the same for any number of threads.
template <typename T>
std::vector<T> ParallelMap(size_t n, const std::function<T(size_t)>& function) {
  std::vector<T> results(n);
  ParallelFor(n, [&](size_t i) { results[i] = function(i); });
  return results;
}

}  // namespace calibrato
