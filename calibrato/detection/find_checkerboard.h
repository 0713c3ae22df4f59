#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// All inner corners of a checkerboard, to sub-pixels, in the board's order (corner_order.h);
/// nothing where no whole board was found, or one with a corner less than 1 px inside the image.
/// Deterministic.
/// @param half_window  Of the refinement [px]; 0 means 5 or a third of the smallest corner spacing.
/// @pre At least 3 rows and 3 columns.
[[nodiscard]] std::optional<Eigen::Matrix2Xd> FindCheckerboard(const GreyImage& image,
                                                               const Checkerboard& board,
                                                               int half_window);

}  // namespace calibrato
