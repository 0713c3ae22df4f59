#pragma once

#include <cstdint>
#include <vector>

#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// A grey image of 8 bits, row by row from the top left.
struct GreyImage {
  Resolution resolution;
  std::vector<uint8_t> pixels;  ///< width * height
};

/// A colour image: red, green, blue, of 8 bits each, row by row from the top left.
struct RgbImage {
  Resolution resolution;
  std::vector<uint8_t> pixels;  ///< 3 * width * height
};

}  // namespace calibrato
