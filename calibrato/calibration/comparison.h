#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "calibrato/calibration/chi_square.h"
#include "calibrato/calibration/image_map.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"

// Do two calibrations of the same camera differ, and by how many pixels? The results must be of
// different data: what they share makes them look more alike than they are.

namespace calibrato {

/// A camera as a calibration found it.
struct CameraEstimate {
  CameraModel model;
  Resolution resolution;
  /// Marginal covariance of the parameters, zero rows and columns for held ones; empty if unknown.
  Eigen::MatrixXd covariance;
};

/// Whether a difference is more than chance.
struct Significance {
  double statistic = std::numeric_limits<double>::quiet_NaN();
  double degrees = std::numeric_limits<double>::quiet_NaN();  ///< Of its chi-square law.
  /// That chance alone makes the difference as large; NaN where a covariance is missing.
  double probability = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] bool is_known() const { return !std::isnan(probability); }
  [[nodiscard]] bool is_significant() const { return probability < kSignificance; }
};

/// d' (A + B)^-1 d of a difference of two independent estimates with covariances A and B, over the
/// entries that vary in at least one of them. Unknown where there is none.
[[nodiscard]] Significance SignificanceOf(const Eigen::VectorXd& difference,
                                          const Eigen::MatrixXd& covariance_of_difference);

/// By how much the focal lengths changed, if nothing else of the lens did: focus and temperature do
/// that. Told from all parameters, which would have to have changed with them, it is known far
/// better than the difference of fu alone.
struct FocalChange {
  double relative = std::numeric_limits<double>::quiet_NaN();  ///< Of fu and fv alike [-].
  double sigma = std::numeric_limits<double>::quiet_NaN();
  Significance significance;  ///< With one degree of freedom.
};

struct CameraComparison {
  /// The turn that is taken out before pixels are compared: a direction r of the first camera is
  /// Exp(rotation) r in the second. It moves the image as a shift of the principal point does, and
  /// neither result can know it.
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< [rad]
  /// Distance between where the two see the same direction, after that turn [px]; of points at
  /// infinity.
  ImageMap difference_px;
  /// Root mean square of the difference over the image, and of what the covariances let expect; NaN
  /// where one is missing.
  double rms_px = std::numeric_limits<double>::quiet_NaN();
  double expected_rms_px = std::numeric_limits<double>::quiet_NaN();
  /// Of the parameters' difference where both results are of one model with the same parameters
  /// held; else of the difference in pixels.
  Significance significance;
  bool by_parameters = false;  ///< Which of the two it is.
  FocalChange focal_change;    ///< Known where it is by parameters.
};

/// @throws InputError if the resolutions differ, or if no part of the image is seen by both.
[[nodiscard]] CameraComparison CompareCameras(const CameraEstimate& first,
                                              const CameraEstimate& second);

/// Of a pose between two cameras, with covariances of its perturbation (geometry/rigid3.h).
struct PoseComparison {
  double rotation_rad = 0.0;
  double translation_m = 0.0;
  Significance significance;
};

/// @param first_covariance, second_covariance  6x6; empty if unknown.
[[nodiscard]] PoseComparison ComparePoses(const Rigid3& first,
                                          const Eigen::MatrixXd& first_covariance,
                                          const Rigid3& second,
                                          const Eigen::MatrixXd& second_covariance);

}  // namespace calibrato
