#pragma once

#include <optional>

#include "calibrato/detection/rejection.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// The inner corners of a ChArUco board that are in sight, to sub-pixels. Deterministic.
///
/// The corners are found as those of a checkerboard are; then the markers in the white squares
/// between four of them are read, and tell which part of the board it is. At least two must agree.
[[nodiscard]] std::optional<BoardView> FindCharuco(const GreyImage& image, const Charuco& board,
                                                   RejectionCounts* rejected);

}  // namespace calibrato
