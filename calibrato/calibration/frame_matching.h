#pragma once

#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// How far apart stamps of one frame may lie: half the median interval between a camera's views
/// (the least of all cameras), at most 20 ms; 0 where no camera has two views.
[[nodiscard]] Duration DefaultStampTolerance(const std::vector<std::vector<BoardView>>& views);

/// [camera][view]: the number of the frame that each view is a part of, for cameras whose views are
/// in order of time on one clock. Frames are numbered in order of time; each holds at most one view
/// a camera, with stamps that differ by at most the tolerance, the nearest where several would do.
[[nodiscard]] std::vector<std::vector<int>> FramesByStamp(
    const std::vector<std::vector<BoardView>>& views, Duration tolerance);

}  // namespace calibrato
