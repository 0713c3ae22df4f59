#pragma once

#include <Eigen/Core>

#include "calibrato/calibration/camera_calibration.h"

namespace calibrato {

/// Whether residuals are more than noise, as they are where the model does not fit the lens. Noise
/// has no neighbours: what it does at one corner it does not know at the next. What a wrong model
/// leaves is smooth.
struct ResidualField {
  static constexpr int kColumns = 8;
  static constexpr int kRows = 6;
  /// Means over the cells of a grid on the image, kRows x kColumns, predicted - measured [px]; NaN
  /// in empty cells.
  Eigen::MatrixXd mean_u;
  Eigen::MatrixXd mean_v;
  Eigen::MatrixXi num_corners;
  /// Of the residuals of corners that are neighbours on the board, in the same view [-]: about the
  /// share of their variance that is smooth. For noise 0, or a little less: poses are fitted to it.
  double neighbour_correlation = 0.0;
  double correlation_sigma = 0.0;  ///< Its spread where residuals are noise [-].
  double systematic_rms_px = 0.0;  ///< Root mean square length of the smooth part [px].
};

/// @pre the calibration has a model
[[nodiscard]] ResidualField ResidualFieldOf(const CameraCalibration& calibration,
                                            Resolution resolution);

}  // namespace calibrato
