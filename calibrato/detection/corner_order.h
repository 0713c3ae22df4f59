#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// Renumbers a checkerboard's corners as its frame demands. A finder knows the grid only up to
/// turning and mirroring; here the board's z axis is made to point towards the camera, and of the
/// sides that remain the one is chosen that SearchForBoard describes.
/// Nothing where the squares between the corners are not black and white by turns: then this is no
/// checkerboard, or only a part of these corners is on it.
/// @param pixels  Corner (row, column) in column row * columns + column [px].
[[nodiscard]] std::optional<Eigen::Matrix2Xd> OrderCorners(const GreyImage& image,
                                                           const Checkerboard& board,
                                                           const Eigen::Matrix2Xd& pixels);

}  // namespace calibrato
