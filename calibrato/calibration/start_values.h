#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/calibration/bundle_adjustment.h"

namespace calibrato {

/// Where to start the bundle adjustment from, found in the data alone.
struct StartValues {
  BundleAdjustmentState state;     ///< Of the views that could be started.
  std::vector<size_t> used_views;  ///< Their indices, ascending.
};

/// The principal point starts in the middle of the image, the distortion at zero. The focal length
/// is the best of Zhang's closed form for square pixels ("A flexible new technique for camera
/// calibration", PAMI 2000) and a geometric series of fields of view: the one whose board poses, by
/// homography and then refined, leave the least reprojection error. Parameters given in `known`
/// keep that value.
/// @param known  One a parameter, NaN where unknown; empty means that all are.
/// @return nothing if no view could be started at any focal length.
[[nodiscard]] std::optional<StartValues> FindStartValues(const std::string& model_name,
                                                         Resolution resolution,
                                                         const std::vector<BoardView>& views,
                                                         const Eigen::VectorXd& known = {});

}  // namespace calibrato
