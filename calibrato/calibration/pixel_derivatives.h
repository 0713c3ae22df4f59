#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// Where a camera sees a point, and how that changes with the point and with the parameters: for
/// the few points of a map over the image. (Solvers linearise whole views: view_fit.h.)
struct PixelDerivatives {
  Eigen::Vector2d pixel;                 ///< [px]
  Eigen::Matrix<double, 2, 3> by_point;  ///< d pixel / d p_c
  Eigen::Matrix2Xd by_parameters;        ///< d pixel / d parameters
};

/// Nothing where the point lies outside the model's domain.
[[nodiscard]] std::optional<PixelDerivatives> ProjectWithDerivatives(const CameraModel& model,
                                                                     const Eigen::Vector3d& p_c);

}  // namespace calibrato
