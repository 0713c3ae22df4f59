#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/calibration/outliers.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// Where to start the bundle adjustment from, found in the data alone.
struct StartValues {
  CameraModel model;
  /// One a view: its pose, and the corners that project from it; none where no pose was found.
  std::vector<ViewInliers> views;
};

/// In three steps, for lenses of any field of view that the model can have:
/// 1. Undistorted lenses of the model's family, of all fields of view and (for the models that have
///    one) a few shapes, principal point in the middle of the image, are tried on a dozen views: a
///    board pose from the rays of each (plane_pose.h), and the reprojection error of it.
/// 2. The best of each shape is adjusted to these views, all parameters free, with a loss that
///    forgives outliers.
/// 3. The pose of every view with the one that ends lowest. For the models of which a calibration
/// can
///    have minima far apart it is adjusted to all views before, its twins (lens_twin.h) likewise,
///    and the lowest is taken.
/// Parameters given in `known` start with that value, and those in `fixed` keep it.
/// @param known, fixed  One a parameter, NaN where unknown; empty means that all are unknown, free.
/// @return nothing if no view could be started with any lens.
[[nodiscard]] std::optional<StartValues> FindStartValues(const std::string& model_name,
                                                         Resolution resolution,
                                                         const std::vector<BoardView>& views,
                                                         const Eigen::VectorXd& known = {},
                                                         const std::vector<bool>& fixed = {});

/// The pose of one view, from its rays and then refined, with the corners that project from it. No
/// corners where no pose of the board explains the view, or fewer than half of them project.
[[nodiscard]] ViewInliers StartView(const CameraModel& model, const BoardView& view,
                                    int max_iterations = 5);

}  // namespace calibrato
