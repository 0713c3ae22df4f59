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
/// @return The maps around those that remain; of the others no map.
[[nodiscard]] std::vector<LocalMap> RemoveStrays(
    const Eigen::Matrix2Xd& board, const Eigen::Vector2d& steps_m,
    std::vector<std::optional<Eigen::Vector2d>>* corners, RejectionCounts* rejected);

}  // namespace calibrato
