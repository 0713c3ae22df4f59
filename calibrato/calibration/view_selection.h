#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

// Which views of a recording are worth keeping.

namespace calibrato {

struct CoverageSelectionOptions {
  /// A view is new if its X, Y, size and skew (coverage.h) differ from those of every view kept so
  /// far by more than this, summed over the four [-]. The original's; stock ROS has 0.2.
  double novelty = 0.15;
  /// Views in which the board moved faster than this are left out, as blurred. In image widths a
  /// second: at 640 px and an exposure of 5 ms about a pixel of blur. Not tested without stamps.
  double max_speed_per_s = 0.3;
};

/// The views that the paper's estimator would have put into its database (appendix A): new ones,
/// while the board moved slowly. Indices, ascending; the first view is always among them.
[[nodiscard]] std::vector<size_t> SelectByCoverage(const std::vector<BoardView>& views,
                                                   Resolution resolution,
                                                   const CoverageSelectionOptions& options = {});

/// Two views in which corners moved by less than this on the average hardly differ in where corners
/// lie within their pixels, on which a detector's small errors depend [px].
inline constexpr double kDistinctWayPx = 0.3;

/// The views that differ from every view kept before them, by the mean way of the corners that both
/// hold [px]. A camera that hovers, or returns to where it was, repeats its corners' errors
/// together with its views, beside what noise its sensor adds: counted as so many measurements they
/// would make covariances too small. Indices, ascending; views without common corners differ.
[[nodiscard]] std::vector<size_t> SelectDistinct(const std::vector<BoardView>& views,
                                                 double least_way_px = kDistinctWayPx);

/// How fast the board moves in the image [px/s] at each view: the mean way of the corners that it
/// shares with the view before it. Nothing for the first view, without time between them, or where
/// no corner is shared.
[[nodiscard]] std::vector<std::optional<double>> BoardSpeeds(const std::vector<BoardView>& views);

/// What each used view of a calibration says of the camera's parameters, with its pose unknown and
/// for the estimated noise. Held parameters have zero rows and columns.
/// @pre the calibration has a covariance
[[nodiscard]] std::vector<Eigen::MatrixXd> InformationOfViews(const CameraCalibration& calibration,
                                                              const std::vector<bool>& fixed);

struct InformationSelectionOptions {
  /// Stop when the best of the views that are left would lower the criterion by less than this
  /// share
  /// [-].
  double least_gain = 0.01;
  size_t min_views = 3;
};

struct InformationSelection {
  std::vector<size_t> kept;  ///< Indices, ascending. Empty where even all views leave a rank open.
  double a_optimality_kept = 0.0;  ///< Trace of the block's marginal covariance with these views.
  double a_optimality_all = 0.0;   ///< With all of them.
  /// So many of the first views already knew as much as the kept ones: the rest of the recording
  /// was not needed.
  size_t num_enough = 0;
};

/// Greedy: the view that lowers the trace of the marginal covariance of `block` most is kept next,
/// until none lowers it by enough. Additive information makes each trial one small inverse; the
/// cost is candidates x kept.
/// @param information  Of each view, as from InformationOfViews; or of each frame of several
///                     cameras about the border (bundle_adjustment.h).
/// @param block        What is to be known: indices of fu fv pu pv, in units of 1 px (held ones
///                     count as known).
[[nodiscard]] InformationSelection SelectByInformation(
    const std::vector<Eigen::MatrixXd>& information, const std::vector<Eigen::Index>& block,
    const InformationSelectionOptions& options = {});

/// How long the recording had to be for its first `num_views` views: from the first of them to the
/// last. Nothing without stamps.
[[nodiscard]] std::optional<Duration> TimeOfFirst(size_t num_views,
                                                  const std::vector<BoardView>& views);

}  // namespace calibrato
