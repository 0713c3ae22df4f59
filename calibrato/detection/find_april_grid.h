#pragma once

#include <optional>

#include "calibrato/detection/rejection.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// The corners of all tags of an AprilGrid that are in sight, to sub-pixels. Deterministic.
///
/// Tags are found by their corners, which the small squares make saddles (dark_quads.h), and read;
/// those beside them, whose corners were not found at first, are looked for where their neighbours
/// make them expected. On photos of such boards this finds tags that the detectors of ArUco and
/// AprilTag, which look for outlines, do not: a tag and its four squares have one outline together.
[[nodiscard]] std::optional<BoardView> FindAprilGrid(const GreyImage& image, const AprilGrid& board,
                                                     RejectionCounts* rejected);

}  // namespace calibrato
