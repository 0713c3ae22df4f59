#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/calibration/coverage.h"
#include "calibrato/calibration/information.h"
#include "calibrato/calibration/rejection.h"
#include "calibrato/calibration/termination.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// Fewer views than this determine no camera.
inline constexpr int kMinViews = 3;

/// One camera and the views of a planar board (z = 0 in frame g) that it took.
struct CameraProblem {
  std::string model = "pinhole-radtan";
  Resolution resolution;
  std::vector<BoardView> views;
  /// Parameters to hold, by index, at the value in `known`. Both empty, or both of the model's
  /// size.
  std::vector<bool> fixed;
  /// NaN where not known; else used as the start value. What is held at NaN is held as
  /// HoldParameters says of parameters without a value.
  Eigen::VectorXd known;
  /// Whether corners and views that do not fit are left out (outliers.h). Where all of them fit,
  /// the result is that of plain least squares.
  bool reject_outliers = true;
};

/// Which parameters to hold: "k1", or "fu=458.6" where their value is known. Without a value
/// distortion is held at 0, the principal point in the middle of the image, and any other parameter
/// (focal lengths, xi, alpha, beta) where the same views have it when it is free: the estimate
/// stays, but its error is taken for zero.
/// @throws InputError for a name that the model does not have (the names it has are listed) or that
/// is given twice, a value that is no number or out of the parameter's range (focal lengths 1 to
/// 1e6 px, alpha 0 to 1, ..), or if all are held.
void HoldParameters(const std::vector<std::string>& names, CameraProblem* problem);

/// Which parameters are to be held, but have no value of their own: they are estimated first. By
/// index; all false where nothing is held.
[[nodiscard]] std::vector<bool> HeldAtTheirEstimate(const CameraProblem& problem);

/// The fit in which what HeldAtTheirEstimate names was free: its values come from there, so the
/// result is no better than this.
struct FreeFit {
  Termination termination = Termination::kNoStart;
  /// Marginal, of each parameter, as the covariance of CameraCalibration; 0 for those that were
  /// held even here. Empty where the views leave some parameter undetermined.
  Eigen::VectorXd sigmas;
};

struct CameraCalibration {
  Termination termination = Termination::kNoStart;
  std::optional<CameraModel> model;         ///< The estimate; none without start values.
  std::optional<FreeFit> free_fit;          ///< Set where a parameter is held at its estimate.
  std::vector<Rigid3> T_c_g;                ///< Board poses, one a used view.
  std::vector<BoardView> used_views;        ///< Those that fit, without their rejected corners.
  std::vector<size_t> used_view_indices;    ///< Their places in problem.views, ascending.
  std::vector<Eigen::Matrix2Xd> residuals;  ///< Predicted - measured, one a used view [px].
  std::vector<RejectedCorner> rejected_corners;  ///< Of used views.
  /// Without a model: those that fit no lens together with the others.
  std::vector<RejectedView> rejected_views;
  int num_corners = 0;               ///< In the used views, without rejected ones.
  double reprojection_rms_px = 0.0;  ///< sqrt(sum(du^2 + dv^2) / num_corners).
  /// The same over all corners that project, those of rejected views from their best pose [px].
  double reprojection_rms_all_px = 0.0;
  /// Of one coordinate, from the residuals and the degrees of freedom they have left [px].
  double noise_stddev_px = 0.0;
  /// Marginal covariance of all parameters with the poses unknown, scaled by the estimated noise;
  /// zero rows and columns for those that were held. Empty unless it exists.
  Eigen::MatrixXd covariance;
  Information information;  ///< Of fu fv pu pv; set where the covariance is.
  Coverage coverage;        ///< Of the used views.
};

/// Calibrates from nothing but the views: start values, bundle adjustment, covariance. For several
/// cameras, or a board that may be bent, see camera_rig_calibration.h.
/// @throws InputError if a view's points do not lie in the plane z = 0, or no view is given.
[[nodiscard]] CameraCalibration CalibrateCamera(const CameraProblem& problem,
                                                int max_iterations = 200);

}  // namespace calibrato
