#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// Reads a list of corners (docs/formats.md section 3), plain or gzip:
///
///     #timestamp [ns],tag_id,tag_corner,u [px],v [px],x [m],y [m],z [m]
///     1404733405732800000,0,0,175.9867,336.8253,0.0,0.0,0.0
///
/// Columns may stand in any order and are matched by their name before the bracket; others are
/// ignored, tag_corner may be missing. Lines that begin with '#' are comments, except for the first
/// that names the columns. Rows of one stamp, wherever they stand, make one view; views come in
/// order of time, corners in order of their ids. corner_ids = tag_id * 4 + tag_corner for lists
/// that use tag_corner (one row where it is not 0), else tag_id.
/// @param board_points_g  Points by corner id [m] where the file has no x y z; where both are there
/// they must agree to 1 % of the diagonal of the board's bounding box, and the file's are kept.
/// @throws InputError with file and line: missing column, a unit other than that above, field that
/// is not a finite number, id outside the board, a corner that stands twice in a view, no rows,
/// more than 50 million rows; no text, truncated gzip.
[[nodiscard]] std::vector<BoardView> ReadCornerList(
    const std::string& path, const std::optional<Eigen::Matrix3Xd>& board_points_g);

/// The same file's content, with x y z; digits enough to read back the same numbers.
/// @param corners_per_tag  1: the list has tag_id = corner id and tag_corner = 0 (checkerboards);
/// 4: corner id = tag_id * 4 + tag_corner (boards of tags or of separate squares).
[[nodiscard]] std::string CornerListText(const std::vector<BoardView>& views,
                                         int corners_per_tag = 1);

}  // namespace calibrato
