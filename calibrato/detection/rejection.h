#pragma once

namespace calibrato {

/// What was seen in the images, and why it is not in the result.
struct RejectionCounts {
  int corners_near_border = 0;  ///< The window in which they would be refined leaves the image.
  int corners_of_bad_fit = 0;   ///< Too small, too faint, too uncertain, covered, or no corner.
  int tags_not_on_board = 0;    ///< Of the board's family, with a number that the board has not.
  int tags_of_another_family = 0;
  int tags_seen_twice = 0;         ///< Two boards in view, or a reflection: neither is taken.
  int images_with_two_boards = 0;  ///< Alike, so that it can't be told which one is meant.
  int images_with_mirrored_board = 0;
  /// Tags that do not lie to each other as on the board: its rows and columns are swapped, or it is
  /// another one.
  int images_with_other_layout = 0;

  RejectionCounts& operator+=(const RejectionCounts& other) {
    corners_near_border += other.corners_near_border;
    corners_of_bad_fit += other.corners_of_bad_fit;
    tags_not_on_board += other.tags_not_on_board;
    tags_of_another_family += other.tags_of_another_family;
    tags_seen_twice += other.tags_seen_twice;
    images_with_two_boards += other.images_with_two_boards;
    images_with_mirrored_board += other.images_with_mirrored_board;
    images_with_other_layout += other.images_with_other_layout;
    return *this;
  }
  bool operator==(const RejectionCounts&) const = default;
};

}  // namespace calibrato
