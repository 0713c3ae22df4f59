#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/sensors/image.h"

namespace calibrato {

/// A dark patch on brighter ground that looks like an ellipse.
struct DarkBlob {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< Its middle [px].
  double area = 0.0;                                ///< [px^2]
};

/// Those of an image, row by row of their topmost pixel. Blobs that touch the image's border, have
/// less than 12 pixels or more than a fiftieth of the image are left out.
[[nodiscard]] std::vector<DarkBlob> FindDarkBlobs(const GreyImage& image);

}  // namespace calibrato
