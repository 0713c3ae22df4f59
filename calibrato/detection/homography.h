#pragma once

#include <Eigen/Core>

namespace calibrato {

/// The homography from the board to the image, of (x, y, 1), that fits best by least squares of the
/// distances in the image; zero where none does.
/// @param board  At least four points, not on one line.
[[nodiscard]] Eigen::Matrix3d FitHomography(const Eigen::Matrix2Xd& board,
                                            const Eigen::Matrix2Xd& pixels);

}  // namespace calibrato
