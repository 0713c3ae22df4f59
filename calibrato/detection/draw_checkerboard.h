#pragma once

#include <Eigen/Core>

#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// For tests: a picture of a checkerboard, drawn without OpenCV, whose corners are known exactly.
/// @param H_c_g  Homography from (x, y, 1) on the board [m] to the pixel (u, v, 1), up to scale.
/// The board has a white margin of one square; the square outside corner (0, 0), before it in row
/// and column, is black. Behind the board all is grey. Each pixel is the mean of 89
/// samples over a square of 2 px: its own area and the blur of a sharp lens.
[[nodiscard]] GreyImage DrawCheckerboard(const Checkerboard& board, const Eigen::Matrix3d& H_c_g,
                                         Resolution resolution);

/// Where that picture has the board's corners: 2 x N [px].
[[nodiscard]] Eigen::Matrix2Xd DrawnCorners(const Checkerboard& board,
                                            const Eigen::Matrix3d& H_c_g);

/// The homography of a board whose middle is seen at a pixel, `distance_m` away, by a camera with
/// focal length `f` [px]: first tilted about its x axis, then rolled by `roll` in the image, both
/// [rad]; at no roll, x runs down and y to the right.
[[nodiscard]] Eigen::Matrix3d BoardHomography(const Checkerboard& board, double f,
                                              const Eigen::Vector2d& centre, double distance_m,
                                              double tilt, double roll);

}  // namespace calibrato
