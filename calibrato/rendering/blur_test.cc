#include "calibrato/rendering/blur.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace calibrato {
namespace {

// The mean over pixel `u` of a vertical edge at `edge` (0 before, 1 behind), blurred by a Gaussian.
double BlurredEdge(double u, double edge, double stddev) {
  constexpr int kSteps = 200;
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double x = u + (k + 0.5) / kSteps - 0.5 - edge;
    sum += 0.5 * std::erfc(-x / (stddev * std::numbers::sqrt2));
  }
  return sum / kSteps;
}

// Cells of an image with such an edge; pixel 0 is from -0.5 to 0.5.
std::vector<float> EdgeCells(Resolution resolution, int fineness, double edge, bool is_vertical) {
  const int width = resolution.width * fineness;
  const int height = resolution.height * fineness;
  std::vector<float> cells;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const int along = is_vertical ? column : row;
      const double behind = (along + 1.0) / fineness - 0.5 - edge;
      cells.push_back(static_cast<float>(std::clamp(behind * fineness, 0.0, 1.0)));
    }
  }
  return cells;
}

TEST(Blurred, EdgesAreWhatGaussianAndPixelMakeOfThem) {
  const Resolution resolution{40, 30};
  for (const double stddev : {0.5, 0.7, 1.0, 1.5, 2.0, 3.0}) {
    const int fineness = CellsPerPixel(stddev);
    for (const double edge : {15.0, 15.1, 15.25, 15.33, 15.5, 15.7}) {
      for (const bool is_vertical : {true, false}) {
        const std::vector<float> pixels = Blurred(
            EdgeCells(resolution, fineness, edge, is_vertical), resolution, fineness, stddev);
        double centre_of_change = 0.0;
        for (int k = 0; k < 30; ++k) {
          const float level = is_vertical ? pixels[7 * 40 + k] : pixels[k * 40 + 7];
          EXPECT_NEAR(level, BlurredEdge(k, edge, stddev), 5e-3) << stddev << " " << edge;
          centre_of_change += 1.0 - level;
        }
        // The edge stays where it was.
        EXPECT_NEAR(centre_of_change - 0.5, edge, 1e-4) << stddev << " " << edge;
      }
    }
  }
}

TEST(Blurred, LeavesAnEvenImageEvenUpToItsEdges) {
  const Resolution resolution{9, 7};
  for (const double stddev : {0.5, 1.0, 3.0}) {
    const int fineness = CellsPerPixel(stddev);
    const std::vector<float> cells(resolution.width * resolution.height * fineness * fineness,
                                   50.0F);
    for (const float level : Blurred(cells, resolution, fineness, stddev)) {
      EXPECT_NEAR(level, 50.0F, 1e-4);
    }
  }
}

}  // namespace
}  // namespace calibrato
