#include "calibrato/rendering/blur.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace calibrato {
namespace {

// The integral from minus infinity of a Gaussian's integral: for the mean of blurred edges.
double TwiceIntegrated(double x, double stddev) {
  const double z = x / stddev;
  const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
  return stddev * (z * 0.5 * std::erfc(-z / std::numbers::sqrt2) + density);
}

// The weight of each cell for a pixel, from the cell `reach` before the pixel's first to that as
// far behind its last: the light that the pixel has from that cell. An edge within a cell comes out
// as if it were spread over the cell, too wide by a sixth of a cell's squared width on average; so
// the Gaussian is that much narrower.
std::vector<float> Weights(int fineness, double stddev_px) {
  const double cell = 1.0 / fineness;
  const double stddev = std::sqrt(std::max(stddev_px * stddev_px - cell * cell / 6.0, 1e-6));
  const int reach = static_cast<int>(std::ceil(4.5 * stddev_px * fineness));
  // Light that a pixel from 0 to 1 has from all that lies before x.
  const auto light_before = [&](double x) {
    return TwiceIntegrated(x, stddev) - TwiceIntegrated(x - 1.0, stddev);
  };
  std::vector<float> weights;
  double sum = 0.0;
  for (int k = -reach; k < fineness + reach; ++k) {
    weights.push_back(static_cast<float>(light_before((k + 1) * cell) - light_before(k * cell)));
    sum += weights.back();
  }
  for (float& weight : weights) weight = static_cast<float>(weight / sum);
  return weights;
}

}  // namespace

int CellsPerPixel(double stddev_px) {
  if (stddev_px == 0.0 || stddev_px >= 2.0) return 1;
  return stddev_px >= 1.0 ? 2 : 4;
}

std::vector<float> Blurred(const std::vector<float>& cells, Resolution resolution, int fineness,
                           double stddev_px) {
  const std::vector<float> weights = Weights(fineness, stddev_px);
  const int num_weights = static_cast<int>(weights.size());
  const int reach = (num_weights - fineness) / 2;
  const int width = resolution.width * fineness;
  const int height = resolution.height * fineness;
  assert(cells.size() == static_cast<size_t>(width) * height);
  // Cells of one row, sorted by their place in a pixel, with what lies beyond the edges: so that
  // neighbouring pixels find theirs side by side.
  const int beyond = (reach + fineness - 1) / fineness;
  const int num_places = resolution.width + 2 * beyond;
  std::vector<float> column_sums(width);
  std::vector<float> sorted(static_cast<size_t>(num_places) * fineness);
  std::vector<float> pixels(static_cast<size_t>(resolution.width) * resolution.height, 0.0F);
  for (int v = 0; v < resolution.height; ++v) {
    std::fill(column_sums.begin(), column_sums.end(), 0.0F);
    for (int k = 0; k < num_weights; ++k) {
      const int row = std::clamp(v * fineness + k - reach, 0, height - 1);
      const float* source = cells.data() + static_cast<size_t>(row) * width;
      const float weight = weights[k];
      float* sums = column_sums.data();
      for (int column = 0; column < width; ++column) sums[column] += weight * source[column];
    }
    for (int place = 0; place < num_places; ++place) {
      for (int part = 0; part < fineness; ++part) {
        const int column = std::clamp((place - beyond) * fineness + part, 0, width - 1);
        sorted[static_cast<size_t>(part) * num_places + place] = column_sums[column];
      }
    }
    float* row_pixels = pixels.data() + static_cast<size_t>(v) * resolution.width;
    for (int k = 0; k < num_weights; ++k) {
      const int offset = k - reach + beyond * fineness;  // from the first pixel's cell, >= 0
      const float* source =
          sorted.data() + static_cast<size_t>(offset % fineness) * num_places + offset / fineness;
      const float weight = weights[k];
      for (int u = 0; u < resolution.width; ++u) row_pixels[u] += weight * source[u];
    }
  }
  return pixels;
}

}  // namespace calibrato
