#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// A view of the corners that were found, in the order of their numbers; nothing where there are
/// fewer than eight (or fewer than all, on smaller boards), or all are on one line: these tell next
/// to nothing about a camera and may be found by chance.
/// @param corners   By number on the board [px].
/// @param points_g  All points of the board [m], 3 x as many.
[[nodiscard]] std::optional<BoardView> ViewOf(
    const std::vector<std::optional<Eigen::Vector2d>>& corners, const Eigen::Matrix3Xd& points_g);

}  // namespace calibrato
