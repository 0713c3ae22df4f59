#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/measurements.h"

// To add a board: its finder in a file of its own beside find_checkerboard.h, its line in
// DetectBoard and in the suggestions of detect.cc.

namespace calibrato {

struct DetectionOptions {
  /// Half the width of the window in which a corner is refined [px]; 0 means 5 or a third of the
  /// corner spacing, whichever is smaller.
  int refinement_half_window = 0;
};

/// The board in one image: corners to sub-pixels, in the board's order with its frame's handedness
/// (z towards the camera). Nothing where no whole board was found; corners within about
/// 8 px of the border are not looked for, and none closer than 1 px is ever given. Stamp and name
/// are left to the caller.
///
/// A checkerboard looks the same from several sides. Which corner is (0, 0):
/// - where the colours tell (rows + columns odd; two of the four sides of a square board of odd
///   size): the one whose outer square, before it in row and column, is black;
/// - among those that still look the same: the one nearest to the top left of the image.
/// @throws InputError for a checkerboard of less than 3 rows or columns, which can't be found.
[[nodiscard]] std::optional<BoardView> DetectBoard(const GreyImage& image, const Board& board,
                                                   const DetectionOptions& options = {});

/// What was found in one camera's images.
struct Detections {
  std::vector<BoardView> views;  ///< In the order of the images.
  Resolution resolution;         ///< Of the images with the board.
  int num_images = 0;
  std::vector<std::string>
      images_without_board;  ///< Their names. They never count against the rest.
};

/// Where images come from: their names and how to get number k. Detection does not know of files.
struct ImageSource {
  std::vector<std::string> names;
  std::function<GreyImage(size_t)> load;  ///< Called from several threads at once; may throw.
  std::vector<Time> stamps;  ///< As many as names, passed on to the views; empty: all 0.
};

/// Searches all images in parallel, each loaded when its turn comes and forgotten after it.
/// @throws InputError: an image that can't be loaded; boards found at two image sizes; no board in
/// any image (says how many images, what was searched for, and which board would have been found:
/// squares counted instead of inner corners, one row or column too many or too few).
[[nodiscard]] Detections DetectBoards(const ImageSource& images, const Board& board,
                                      const DetectionOptions& options = {});

}  // namespace calibrato
