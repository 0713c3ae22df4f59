#include "calibrato/calibration/image_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace calibrato {

Eigen::Vector2d ImageMapPixel(Resolution resolution, Eigen::Index row, Eigen::Index column) {
  return {static_cast<double>(column) / (kImageMapColumns - 1) * (resolution.width - 1),
          static_cast<double>(row) / (kImageMapRows - 1) * (resolution.height - 1)};
}

ImageMap MapOverImage(Resolution resolution,
                      const std::function<double(const Eigen::Vector2d&)>& quantity) {
  ImageMap map;
  map.values.resize(kImageMapRows, kImageMapColumns);
  std::vector<double> known;
  for (Eigen::Index row = 0; row < kImageMapRows; ++row) {
    for (Eigen::Index column = 0; column < kImageMapColumns; ++column) {
      const double value = quantity(ImageMapPixel(resolution, row, column));
      map.values(row, column) = value;
      if (!std::isnan(value)) known.push_back(value);
    }
  }
  if (known.empty()) return map;
  std::sort(known.begin(), known.end());
  map.median = 0.5 * (known[(known.size() - 1) / 2] + known[known.size() / 2]);
  map.worst = known.back();
  return map;
}

}  // namespace calibrato
