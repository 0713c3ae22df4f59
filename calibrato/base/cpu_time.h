#pragma once

namespace calibrato {

/// What the calling thread has computed since it began [s]. A body of a parallel loop is measured
/// by the difference of two calls: loops inside it stay on its thread.
double ThreadCpuSeconds();

/// What all threads of the process have computed since it began [s], for work that nothing else is
/// done beside.
double ProcessCpuSeconds();

}  // namespace calibrato
