#pragma once

#include <optional>
#include <vector>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/outliers.h"
#include "calibrato/calibration/termination.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// One camera fitted to its views: the estimate without what is said of it.
struct CameraFit {
  Termination termination = Termination::kNoStart;
  std::optional<CameraModel> model;  ///< None where fewer than kMinViews fit one lens.
  /// One a view of the problem, with poses T_c_g. Without a model: which of them fit one lens, too
  /// few, and why the others do not; empty where no lens was found at all.
  std::vector<ViewInliers> views;
  double squared_error_px2 = 0.0;   ///< Of the corners that take part.
  std::optional<FreeFit> free_fit;  ///< As in CameraCalibration.

  [[nodiscard]] int num_used_views() const;
};

/// Start values, then bundle adjustment of the corners that fit, in rounds until they no longer
/// change: after each, what exceeds the noise's kOutlierSigmas is left out, and what fits is taken
/// back in.
[[nodiscard]] CameraFit FitCamera(const CameraProblem& problem, int max_iterations);

/// What is known of a camera once it is fitted: model, used views, residuals, what was left out,
/// and coverage; not the noise, the covariance, nor what follows from it. Without a model only what
/// was left out.
[[nodiscard]] CameraCalibration DescribedFit(const CameraProblem& problem, const CameraFit& fit);

}  // namespace calibrato
