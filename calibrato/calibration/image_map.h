#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>

#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// A quantity over the image, on a grid whose outermost points are the centres of the outermost
/// pixels.
struct ImageMap {
  /// Entry (row, column); NaN where the quantity does not exist (no ray through that pixel).
  Eigen::MatrixXd values;
  double median = std::numeric_limits<double>::quiet_NaN();  ///< Over the rest; NaN for none.
  double worst = std::numeric_limits<double>::quiet_NaN();   ///< The largest; NaN for none.
};

inline constexpr int kImageMapColumns = 32;
inline constexpr int kImageMapRows = 24;

/// The pixel of a grid point.
[[nodiscard]] Eigen::Vector2d ImageMapPixel(Resolution resolution, Eigen::Index row,
                                            Eigen::Index column);

/// @param quantity  Of a pixel; NaN where it does not exist.
[[nodiscard]] ImageMap MapOverImage(Resolution resolution,
                                    const std::function<double(const Eigen::Vector2d&)>& quantity);

}  // namespace calibrato
