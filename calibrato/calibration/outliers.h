#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/calibration/rejection.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// No corner is an outlier unless its error is longer than this many sigmas of the noise of one
/// coordinate. Of Gaussian errors one in 270,000 is that long (exp(-5^2 / 2)).
inline constexpr double kOutlierSigmas = 5.0;

/// Nor unless this share, at most, of what is left out may be Gaussian noise: a single corner that
/// is a little too far off tells nothing yet. It is also the chance that anything is left out where
/// there are no outliers, so that leaving them out changes neither the estimate nor its covariance.
inline constexpr double kFalseDiscoveryRate = 1e-3;

/// A view with fewer corners says too little of the board's pose to be checked against it.
inline constexpr int kMinCorners = 4;

/// Noise of one coordinate [px] from the median of the lengths of all errors: up to half of them
/// may be outliers. For Gaussian errors the median of e^2 is 2 ln 2 sigma^2. 0 without errors.
[[nodiscard]] double NoiseFromMedian(std::vector<double> squared_errors_px2);

/// The length of error above which a corner is an outlier [px], and at least a thousandth of a
/// pixel. With the noise sigma of NoiseFromMedian and N errors,
///
///     threshold = sigma max(kOutlierSigmas, sqrt(2 ln(N / (kFalseDiscoveryRate k)))),
///
/// k the largest number such that k errors are that long, else 1: Y. Benjamini and Y. Hochberg,
/// "Controlling the false discovery rate", J. R. Statist. Soc. B 57 (1995).
[[nodiscard]] double OutlierThreshold(std::vector<double> squared_errors_px2);

/// Which corners of a view take part in a fit, and from which pose.
struct ViewInliers {
  Rigid3 T_c_g;
  std::vector<bool> corners;  ///< One a corner; all false where the view is left out.
  /// Why the view is left out; meaningful only where it is.
  ViewRejection reason = ViewRejection::kNoPose;

  [[nodiscard]] int count() const;
};

/// The view with the corners that take part.
[[nodiscard]] BoardView InliersOf(const BoardView& view, const ViewInliers& inliers);

/// Judges a view with the camera held: corners with an error above the threshold [px] are left out,
/// and the whole view where fewer than half of its corners, or than kMinCorners, are below. Before
/// it leaves a view out it looks for a better pose (PoseFromView, and the mirrored one).
/// @param before  Its pose is tried first, if the view was not left out.
[[nodiscard]] ViewInliers JudgedView(const CameraModel& model, const BoardView& view,
                                     const ViewInliers& before, double threshold_px);

}  // namespace calibrato
