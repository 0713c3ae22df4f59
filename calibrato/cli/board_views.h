#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/detection/rejection.h"
#include "calibrato/recording/recording.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// Which part of a recording is used: the options --from, --to, --every.
struct RecordingWindow {
  std::optional<double> from_s;  ///< After the recording's first image [s].
  std::optional<double> to_s;    ///< Likewise.
  int every = 1;                 ///< One frame in so many, beginning with the first.
};

/// One camera's views of the board.
struct CameraViews {
  std::vector<BoardView> views;
  /// The frame that each view is a part of, for all cameras alike: by stamps, or, of photos without
  /// stamps, by number.
  std::vector<int> frame_of_view;
  Resolution resolution;
  std::vector<std::string> images_without_board;
  RejectionCounts rejected;
  bool is_numbered_by_continuity = false;     ///< As in Detections.
  std::optional<InputError::Parts> no_board;  ///< Likewise: set where no image shows it.
};

/// Finds the board in the recording's images, or takes the corners that it has; a line of progress
/// on stderr.
/// @throws InputError: unknown image size of corner lists, images without a board to search for, a
/// window in time of photos without stamps, nothing left in the window; and all that DetectBoards
/// throws.
[[nodiscard]] std::vector<CameraViews> FindBoardViews(const Recording& recording,
                                                      const std::optional<Board>& board,
                                                      const RecordingWindow& window);

/// The same, but a camera that never saw the board has no views and says why (`no_board`).
/// @throws InputError likewise, but of boards that were not found only where no camera saw one.
[[nodiscard]] std::vector<CameraViews> FindBoardViewsOfAny(const Recording& recording,
                                                           const std::optional<Board>& board,
                                                           const RecordingWindow& window);

}  // namespace calibrato
