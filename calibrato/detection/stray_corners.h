#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/detection/local_map.h"
#include "calibrato/detection/rejection.h"

namespace calibrato {

/// Removes corners that are not where their neighbours make them expected, since something else
/// nearby was taken for them: the worst first, for it lets its neighbours look bad. What is allowed
/// is a quarter of the shorter step to the next corner, at least 1 px.
/// @param steps_m  To the next corner, along x and along y [m].
/// @param fit  What their neighbours make expected; it is not asked about fewer than four.
/// @param share_of_worst  Those that are so far off, beside the worst, go at the same time, 0 to 1:
/// 1 where a corner misleads its neighbours, less where all points together tell where each is and
/// one fit for each stray would take long.
/// @return The maps around those that remain; of the others no map.
[[nodiscard]] std::vector<LocalMap> RemoveStrays(
    const Eigen::Matrix2Xd& board, const Eigen::Vector2d& steps_m, const MapFit& fit,
    double share_of_worst, std::vector<std::optional<Eigen::Vector2d>>* corners,
    RejectionCounts* rejected);

}  // namespace calibrato
