#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calibrato/sensors/board.h"

namespace calibrato {

/// What is black on a board: the one description from which boards are drawn on paper and rendered.
/// Everything lies in the plane z = 0 of the board frame g [m]; "anticlockwise" is as seen from the
/// front, where z points to, that is, from x to y.
struct BoardPattern {
  /// A closed polygon, its last corner joined to its first. Anticlockwise around black, clockwise
  /// around white inside black.
  using Outline = std::vector<Eigen::Vector2d>;
  struct Disc {
    Eigen::Vector2d centre;
    double radius_m;
  };

  std::vector<Outline> outlines;  ///< Those of separate black areas touch in corners at most.
  std::vector<Disc> discs;        ///< Black, apart from each other and from the outlines.
  Eigen::AlignedBox2d sheet;      ///< The white sheet on which all this lies.
  /// The axis of g that points to the right where the board hangs upright on a wall: x of boards
  /// whose y points up, y of those whose x points down.
  Eigen::Vector2d right = Eigen::Vector2d::UnitX();
};

/// - Checkerboard: (rows + 1) x (columns + 1) squares; that before corner (0, 0) in row and column
///   is black.
/// - AprilGrid: tags of 10 x 10 modules, and a black square of the gap's width at each corner of
///   each tag.
/// - Circle grid: discs half as wide as the nearest centres are apart. (Neither Kalibr nor OpenCV
///   says; detection does not need to know.)
/// - ChArUco: square (0, 0) is black, a marker in the middle of each white square.
/// The sheet goes beyond all this by half a square, or a gap, or (beyond the centres) by the
/// spacing.
[[nodiscard]] BoardPattern PatternOf(const Board& board);

}  // namespace calibrato
