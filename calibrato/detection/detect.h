#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/detection/rejection.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/measurements.h"

// To add a board: its finder in a file of its own beside find_checkerboard.h, its line in
// SearchForBoard, in the suggestions of similar_board.cc and, where it looks the same from several
// sides, in sensors/board_symmetry.cc.

namespace calibrato {

/// What came of the search for a board in one image.
struct BoardSearch {
  std::optional<BoardView> view;  ///< Without stamp and name, which the caller knows.
  RejectionCounts rejected;       ///< Of this image alone, also where there is a view.
};

/// The board in one image: its corners (of circle grids: the images of the discs' centres) to
/// sub-pixels, in the board's order with its frame's handedness (z towards the camera).
///
/// - Checkerboards and circle grids are found whole or not at all, since a part of one does not
///   tell which part it is; AprilGrids and ChArUco boards are found in parts.
/// - Corners that can't be had to sub-pixels are left out, and counted: within about 7 px of the
///   image's border (less where squares are small), too small or too oblique (squares thinner than
///   4 px), covered or blurred away.
/// - Nothing where fewer than eight corners are left.
///
/// A checkerboard looks the same from several sides, and so do symmetric circle grids. Which corner
/// is (0, 0):
/// - where the colours tell (rows + columns odd; two of the four sides of a square board of odd
///   size): the one whose outer square, before it in row and column, is black;
/// - among those that still look the same: the one nearest to the top left of the image.
/// @throws InputError for a checkerboard or circle grid of less than 3 rows or columns, which can't
/// be told from its background.
[[nodiscard]] BoardSearch SearchForBoard(const GreyImage& image, const Board& board);

/// The same without the counts.
[[nodiscard]] std::optional<BoardView> DetectBoard(const GreyImage& image, const Board& board);

/// What was found in one camera's images.
struct Detections {
  std::vector<BoardView> views;  ///< In the order of the images.
  Resolution resolution;         ///< Of the images with the board; without any, of the first.
  int num_images = 0;
  std::vector<std::string>
      images_without_board;  ///< Their names. They never count against the rest.
  RejectionCounts rejected;  ///< Of all images.
  /// The board looks the same from several sides, and its corners were numbered so that they move
  /// least from one image to the next: worth a note to whoever relies on the board's frame.
  bool is_numbered_by_continuity = false;
  /// Set where no image shows the board: how many were searched, what for, what was seen instead
  /// (squares counted instead of inner corners, one row or column too many or too few, a mirrored
  /// board, two boards at a time, tags of another family or another number), and what to try.
  std::optional<InputError::Parts> no_board;
};

/// Where images come from: their names and how to get number k. Detection does not know of files.
struct ImageSource {
  std::vector<std::string> names;
  std::function<GreyImage(size_t)> load;  ///< Called from several threads at once; may throw.
  std::vector<Time> stamps;  ///< As many as names, passed on to the views; empty: all 0.
};

/// Searches all images in parallel, each loaded when its turn comes and forgotten after it. Where a
/// board looks the same from several sides and the images have stamps (not all of them alike), a
/// board that is turned in front of the camera keeps its corners' numbers from one image to the
/// next.
/// @throws InputError: an image that can't be loaded; boards found at two image sizes; no images.
[[nodiscard]] Detections SearchForBoards(const ImageSource& images, const Board& board);

/// The same.
/// @throws InputError: likewise, and where no image shows the board, with what SearchForBoards says
/// of that.
[[nodiscard]] Detections DetectBoards(const ImageSource& images, const Board& board);

}  // namespace calibrato
