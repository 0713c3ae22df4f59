#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

/// A checkerboard, counted in inner corners as everywhere in this field. Board frame g: the origin
/// is the corner (0, 0), x runs along the row index, y along the column index, z out of the board
/// towards the viewer (as in Kalibr). Corner (row, column) has the number row * columns + column.
struct Checkerboard {
  int rows = 0;                   ///< Inner corners along x, 2 to 1000.
  int columns = 0;                ///< Inner corners along y, 2 to 1000.
  double row_spacing_m = 0.0;     ///< Between rows, along x [m].
  double column_spacing_m = 0.0;  ///< Between columns, along y [m].
  bool operator==(const Checkerboard&) const = default;
};

/// Every board we know. To add one: a struct, its line here, its cases in board.cc, its detector in
/// room `detection`.
using Board = std::variant<Checkerboard>;

/// The points that a detector reports, by number, in frame g [m]: 3 x N.
[[nodiscard]] Eigen::Matrix3Xd BoardPoints(const Board& board);

/// The middle of the bounding box of these points, in frame g [m].
[[nodiscard]] Eigen::Vector3d BoardCentre(const Board& board);

/// "checkerboard of 6 rows x 7 columns of inner corners, squares of 60 x 60 mm", for people.
[[nodiscard]] std::string Describe(const Board& board);

/// Kalibr's target YAML, for example
///     target_type: 'checkerboard'
///     targetCols: 7
///     targetRows: 6
///     rowSpacingMeters: 0.06
///     colSpacingMeters: 0.06
/// @param warnings  Unknown keys are appended. May be null.
/// @throws InputError with line and key.
[[nodiscard]] Board BoardFromValue(const Value& value, std::vector<std::string>* warnings);
[[nodiscard]] Value ToValue(const Board& board);

}  // namespace calibrato
