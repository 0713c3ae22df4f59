#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "calibrato/base/value.h"

// Boards, seen from the front. Board frame g: z out of the board towards the viewer.
//
//   checkerboard, ChArUco, circle grid      AprilGrid                      asymmetric circle grid
//
//   (0,0)---> y  columns                    y  rows                        y  rows
//     | \                                   ^  tag 6   tag 7               ^    o   o   o    row 1
//     v  z                                  |  tag 0   tag 1 ..            |  o   o   o      row 0
//     x  rows                              z+-------> x  columns          z+-------> x  columns

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

/// Kalibr's AprilGrid: tags of the family 36h11 with a black border of two modules, so 10 x 10
/// modules a tag, and small black squares that touch the tags' corners, so that each corner is a
/// saddle like those of a checkerboard. Tag (row, column) has the number row * columns + column;
/// row 0 is the lowest. Board frame g: the origin is the lower left corner of tag 0, x runs along
/// the columns, y up along the rows, z towards the viewer (as in Kalibr). Corner c of a tag has the
/// number 4 * tag + c; c = 0, 1, 2, 3 is its lower left, lower right, upper right, upper left.
struct AprilGrid {
  int rows = 0;              ///< Tags along y, 1 to 587; rows * columns <= 587, the family's size.
  int columns = 0;           ///< Tags along x, likewise.
  double tag_size_m = 0.0;   ///< Side of a tag, with its black border [m].
  double tag_spacing = 0.0;  ///< Gap between two tags, in sides of a tag [-] > 0.
  bool operator==(const AprilGrid&) const = default;
};

/// How many tags the family 36h11 has.
inline constexpr int kNumAprilTags = 587;

/// A grid of black discs; their centres are its points, (row, column) with the number row * columns
/// + column, at
///     symmetric:   (row * spacing, column * spacing, 0)            x along the rows
///     asymmetric:  ((2 column + row % 2) * spacing, row * spacing, 0)   x along the columns
/// as in Kalibr and OpenCV: the spacing of an asymmetric grid is *half* the distance of two discs
/// in a row. z points towards the viewer, so row 0 of an asymmetric grid is the lowest. With an odd
/// number of rows (the usual boards) it is its own mirror image from top to bottom, and looks alike
/// from no other side. With an even number it looks the same upside down, and one that was drawn
/// with row 0 at the top is its mirror image, another board.
struct CircleGrid {
  int rows = 0;            ///< 2 to 1000
  int columns = 0;         ///< 2 to 1000
  double spacing_m = 0.0;  ///< [m]
  bool asymmetric = false;
  bool operator==(const CircleGrid&) const = default;
};

/// A checkerboard with a marker in each white square. Rows and columns are counted in squares, as
/// in OpenCV; its points are the inner corners, (rows - 1) x (columns - 1) of them, numbered row by
/// row. Seen from the front, the square (0, 0) is that at the top left and black, and markers 0, 1,
/// .. follow row by row from there, as in OpenCV from 4.6 on. (Before, boards with an even number
/// of rows began with a white square: they are other boards.) Board frame g as that of a
/// checkerboard: the origin is the corner between squares (0, 0) and (1, 1), x runs down the rows,
/// y along the columns, z towards the viewer.
struct Charuco {
  int rows = 0;                ///< Squares along x, 3 to 1000.
  int columns = 0;             ///< Squares along y, 3 to 1000.
  double square_size_m = 0.0;  ///< [m]
  double marker_size_m = 0.0;  ///< Side of a marker, with its border [m]; below square_size_m.
  std::string dictionary;  ///< One of kMarkerDictionaries; it has a marker for each white square.
  bool operator==(const Charuco&) const = default;
};

/// A set of square markers, named as in OpenCV.
struct MarkerDictionary {
  std::string_view name;
  int num_markers;
};
/// In the order of OpenCV's enumeration.
inline constexpr MarkerDictionary kMarkerDictionaries[] = {{"DICT_4X4_50", 50},
                                                           {"DICT_4X4_100", 100},
                                                           {"DICT_4X4_250", 250},
                                                           {"DICT_4X4_1000", 1000},
                                                           {"DICT_5X5_50", 50},
                                                           {"DICT_5X5_100", 100},
                                                           {"DICT_5X5_250", 250},
                                                           {"DICT_5X5_1000", 1000},
                                                           {"DICT_6X6_50", 50},
                                                           {"DICT_6X6_100", 100},
                                                           {"DICT_6X6_250", 250},
                                                           {"DICT_6X6_1000", 1000},
                                                           {"DICT_7X7_50", 50},
                                                           {"DICT_7X7_100", 100},
                                                           {"DICT_7X7_250", 250},
                                                           {"DICT_7X7_1000", 1000},
                                                           {"DICT_ARUCO_ORIGINAL", 1024},
                                                           {"DICT_APRILTAG_16h5", 30},
                                                           {"DICT_APRILTAG_25h9", 35},
                                                           {"DICT_APRILTAG_36h10", 2320},
                                                           {"DICT_APRILTAG_36h11", kNumAprilTags}};

/// Every board we know. To add one: a struct, its line here, its cases in board.cc (geometry and
/// words), board_file.cc (YAML) and rendering/board_pattern.cc (what is black), its detector in
/// room `detection`.
using Board = std::variant<Checkerboard, AprilGrid, CircleGrid, Charuco>;

/// The points that a detector reports, by number, in frame g [m]: 3 x N.
[[nodiscard]] Eigen::Matrix3Xd BoardPoints(const Board& board);

/// The middle of the bounding box of these points, in frame g [m].
[[nodiscard]] Eigen::Vector3d BoardCentre(const Board& board);

/// Numbers of points that are neighbours along a row of the board (of an AprilGrid: the lower and
/// the upper side of each tag): how finely the board is divided, for scales in an image.
[[nodiscard]] std::vector<std::pair<int, int>> NeighbouringPoints(const Board& board);

/// How many points share a tag_id in a list of corners (docs/formats.md section 3): 4 for an
/// AprilGrid, else 1.
[[nodiscard]] int PointsPerTag(const Board& board);

/// How many points, by number, are found together or not at all: those of a tag of an AprilGrid,
/// one of a ChArUco board, all of a checkerboard or a grid of circles.
[[nodiscard]] int PointsPerPart(const Board& board);

/// "checkerboard of 6 rows x 7 columns of inner corners, squares of 60 x 60 mm", for people.
[[nodiscard]] std::string Describe(const Board& board);

/// Kalibr's target YAML, one of
///     target_type: 'checkerboard'   target_type: 'aprilgrid'   target_type: 'circlegrid'
///     targetCols: 7                 tagCols: 6                 targetCols: 4
///     targetRows: 6                 tagRows: 6                 targetRows: 11
///     rowSpacingMeters: 0.06        tagSize: 0.088             spacingMeters: 0.02
///     colSpacingMeters: 0.06        tagSpacing: 0.3            asymmetricGrid: true
/// (asymmetricGrid may be missing: false), and, which Kalibr has not,
///     target_type: 'charuco'
///     targetCols: 8                 # squares
///     targetRows: 6
///     squareSizeMeters: 0.04
///     markerSizeMeters: 0.03
///     dictionary: 'DICT_5X5_100'
/// @param warnings  Unknown keys are appended. May be null.
/// @throws InputError with line and key.
[[nodiscard]] Board BoardFromValue(const Value& value, std::vector<std::string>* warnings);
[[nodiscard]] Value ToValue(const Board& board);

}  // namespace calibrato
