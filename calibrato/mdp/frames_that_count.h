#pragma once

#include <string>
#include <vector>

#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// The camera model that the intrinsic task estimates: OpenCV's default, as in the paper.
inline constexpr const char* kIntrinsicTaskModel = "pinhole-radtan5";

/// The same for rigs of other lenses: what a camera is estimated as whose truth is of this model.
/// "pinhole-radtan5" for pinholes with that distortion, a part of it or none; any other lens is
/// estimated as what it is, since no polynomial of a pinhole fits it.
[[nodiscard]] std::string IntrinsicTaskModel(const CameraModel& truth);

/// Frames that count in the intrinsic task: every corner at least 8 px inside the image.
[[nodiscard]] std::vector<BoardView> FramesThatCount(std::vector<BoardView> views,
                                                     Resolution resolution);

/// The same for boards that are found in parts (AprilGrid, ChArUco): what is less than 8 px inside
/// is left out, an AprilGrid's tag as a whole, and the frame counts if eight corners are
/// left.
[[nodiscard]] std::vector<BoardView> FramesThatCount(std::vector<BoardView> views,
                                                     Resolution resolution, const Board& board);

}  // namespace calibrato
