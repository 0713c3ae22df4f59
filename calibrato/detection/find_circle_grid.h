#pragma once

#include <optional>

#include "calibrato/detection/rejection.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// The centres of a grid of black discs (disc_centres.h), in the board's order; where it looks the
/// same from several sides, the first disc is the one nearest to the top left of the image. Nothing
/// where no whole grid was found, where there are two, or a mirrored one. Deterministic.
/// @pre At least 3 rows and 3 columns.
[[nodiscard]] std::optional<BoardView> FindCircleGrid(const GreyImage& image,
                                                      const CircleGrid& board,
                                                      RejectionCounts* rejected);

}  // namespace calibrato
