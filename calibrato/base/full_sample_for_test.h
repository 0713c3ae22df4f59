#pragma once

#include <cstdlib>

namespace calibrato {

/// Whether statistical tests draw their full sample: under the label `statistical`
/// (cmake/room.cmake); else a small one.
inline bool FullSample() { return std::getenv("CALIBRATO_FULL_SAMPLE") != nullptr; }

}  // namespace calibrato
