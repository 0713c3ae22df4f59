#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// Sums up, for every cell of a raster, how much of it closed polygons cover: exactly, to the
/// rounding of a float. Cell (column, row) is the square from (column, row) to (column + 1, row +
/// 1). Polygons come as their sides, in any order, and may reach beyond the raster.
///
///     CoverageSum sum({640, 480});
///     for each side from a to b: sum.AddSide(a, b, weight);
///     const std::vector<float> cells = std::move(sum).Finish(0.0);
///
/// A cell gains weight * (its covered part in [0, 1]) * (winding number, positive where sides run
/// anticlockwise as one sees a raster whose rows go down).
///
/// Each side changes only the cells that it crosses: it adds the area between itself and the next
/// cells to the right, of which the sums along each row then make coverages.
class CoverageSum {
 public:
  explicit CoverageSum(Resolution resolution);

  /// @pre Finite. Coordinates far outside cost nothing.
  void AddSide(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double weight);

  /// @param base  What every cell has from the start.
  /// @return width * height cells, row by row.
  std::vector<float> Finish(double base) &&;

 private:
  void AddInside(double x0, double y0, double x1, double y1, double weight);

  int width_;
  int height_;
  std::vector<float> changes_;  // (width + 2) a row: from each cell to the one on its right
};

}  // namespace calibrato
