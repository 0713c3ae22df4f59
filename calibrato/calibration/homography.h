#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrato/geometry/rigid3.h"

namespace calibrato {

/// The homography of a plane: pixel ~ H (x, y, 1), by the normalised direct linear transform
/// (Hartley and Zisserman, Multiple View Geometry, algorithm 4.2), of unit Frobenius norm. Nothing
/// with fewer than four points or points on a line.
[[nodiscard]] std::optional<Eigen::Matrix3d> EstimateHomography(const Eigen::Matrix2Xd& plane,
                                                                const Eigen::Matrix2Xd& image);

/// The pose T_c_g of the plane z = 0 from its homography to normalised image coordinates (x/z,
/// y/z), in front of the camera. Nothing where the homography is degenerate.
[[nodiscard]] std::optional<Rigid3> PoseFromHomography(const Eigen::Matrix3d& H);

}  // namespace calibrato
