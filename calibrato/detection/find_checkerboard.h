#pragma once

#include <optional>

#include "calibrato/detection/rejection.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// The inner corners of a checkerboard, to sub-pixels, in the board's order (corner_order.h);
/// nothing where no whole board was found or where there are two. Corners whose fit is rejected
/// are left out, and counted. Deterministic.
/// @pre At least 3 rows and 3 columns.
[[nodiscard]] std::optional<BoardView> FindCheckerboard(const GreyImage& image,
                                                        const Checkerboard& board,
                                                        RejectionCounts* rejected);

}  // namespace calibrato
