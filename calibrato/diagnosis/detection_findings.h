#pragma once

#include <vector>

#include "calibrato/detection/rejection.h"
#include "calibrato/diagnosis/finding.h"

namespace calibrato {

/// What the search for the board left out and its owner should know: tags that are not of this
/// board, two boards in view, a mirrored image, another layout.
[[nodiscard]] std::vector<Finding> FindingsOnDetection(const RejectionCounts& counts);

}  // namespace calibrato
