#pragma once

#include <vector>

#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// How finely an image must be known to be blurred: cells a pixel and direction. The blurred
/// profile of an edge is right at every cell's boundary and straight between, so wide blurs need
/// less.
[[nodiscard]] int CellsPerPixel(double stddev_px);

/// Blurs by a round Gaussian and takes the mean over each pixel. What is beyond the image's edges
/// is taken to be as on them.
/// @param cells  (fineness * width) x (fineness * height), row by row, each the mean over a cell.
/// @return width * height
[[nodiscard]] std::vector<float> Blurred(const std::vector<float>& cells, Resolution resolution,
                                         int fineness, double stddev_px);

}  // namespace calibrato
