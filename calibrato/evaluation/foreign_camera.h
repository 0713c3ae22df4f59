#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/sensors/board.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

// Calibration of a pinhole with Brown's distortion (pinhole-radtan5) by programs of others, from
// the same corners as ours.

namespace calibrato {

struct ForeignCamera {
  std::string failure;                    ///< Why there is none; empty if there is.
  Eigen::VectorXd parameters;             ///< fu fv pu pv k1 k2 p1 p2 k3.
  std::optional<Eigen::Vector4d> sigmas;  ///< Of fu fv pu pv, where it states them.
  double seconds = 0.0;                   ///< Wall time.
};

/// cv::calibrateCamera with its defaults: flags 0, no guess, its own termination.
[[nodiscard]] ForeignCamera CalibrateByOpenCv(const std::vector<BoardView>& views,
                                              Resolution resolution);

/// mrcal-calibrate-cameras of the mrcal package (http://mrcal.secretsauce.net), as a program, with
/// LENSMODEL_OPENCV5 and its defaults: it also looks for outliers and a bent board. Views with all
/// corners alone.
/// @pre a checkerboard
[[nodiscard]] ForeignCamera CalibrateByMrcal(const std::vector<BoardView>& views,
                                             Resolution resolution, const Checkerboard& board);

}  // namespace calibrato
