#pragma once

#include <utility>
#include <vector>

namespace calibrato {

/// A closed polygon over the corners of a grid's cells, as (row, column): (0, 0) is the corner
/// before cell (0, 0), (1, 1) the one behind it.
using CellOutline = std::vector<std::pair<int, int>>;

/// The outlines of the cells that are false, without corners on straight sides. Around an area they
/// run from rows to columns (anticlockwise where rows run along x and columns along y of a plane
/// seen from the front), around holes the other way. Areas that touch in a corner stay apart.
[[nodiscard]] std::vector<CellOutline> OutlinesOfFalse(const std::vector<std::vector<bool>>& cells);

}  // namespace calibrato
