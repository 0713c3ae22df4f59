#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/detection/rejection.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// Where an image shows the *centres* of a board's black discs, to sub-pixels; nothing where one
/// was rejected, which is counted.
///
/// What can be seen of a disc is its outline, and the middle of that is not the image of the
/// centre: perspective and distortion enlarge one half of the disc more than the other. By how much
/// the centroid of the disc's image is beside it follows from how the image of the board bends
/// there (LocalMap::CentroidOffset) and from the disc's radius. Where all the discs lie tells the
/// one (lens_map.h), how large they are the other, so that nothing about the lens and nothing but
/// the grid about the board has to be known. The difference is 0.05 px for discs of 20 px seen at
/// 45 degrees from a distance of ten times the spacing, and grows with the square of the disc's
/// size.
///
/// Centroids are those of how much darker a pixel is than the white around it, so blur does not
/// shift them.
/// @param board  The centres on the board, (x, y) [m], at least eight and not on one line.
/// @param pixels  About where they are [px].
/// @param areas  About how large the discs are [px^2].
[[nodiscard]] std::vector<std::optional<Eigen::Vector2d>> FindDiscCentres(
    const GreyImage& image, const Eigen::Matrix2Xd& board, const Eigen::Matrix2Xd& pixels,
    const Eigen::VectorXd& areas, RejectionCounts* rejected);

}  // namespace calibrato
