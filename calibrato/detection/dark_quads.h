#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/detection/saddle_field.h"

namespace calibrato {

/// The dark quadrilaterals whose four corners are saddles, such as an AprilGrid's tags (and the
/// small squares between them): their corners clockwise as the image shows them, 2 x 4 [px].
[[nodiscard]] std::vector<Eigen::Matrix<double, 2, 4>> FindDarkQuads(const SaddleField& field);

}  // namespace calibrato
