#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/calibration/termination.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// What is adjusted: one camera's parameters and the board's pose in each view, so that the sum of
/// squared reprojection errors (predicted - measured, [px]) is least.
struct BundleAdjustmentState {
  CameraModel model;
  std::vector<Rigid3> T_c_g;  ///< One a view.
};

struct BundleAdjustmentOptions {
  int max_iterations = 100;
  /// Converged when a step promises to lower the cost by less than this share of it [-].
  double cost_tolerance = 1e-12;
  /// Parameters that keep their start value, by index; empty means none.
  std::vector<bool> fixed_parameters;
};

struct BundleAdjustmentResult {
  BundleAdjustmentState state;
  Termination termination = Termination::kIterationLimit;
  int num_iterations = 0;
  double squared_error_px2 = 0.0;  ///< Sum over corners of du^2 + dv^2.
};

/// Levenberg-Marquardt. The poses are eliminated one by one (each is a 6x6 block, seen by its own
/// view only), so that time and memory are linear in the number of views. Views are worked on in
/// parallel and reduced in their order.
/// @pre every corner projects at the start; one pose a view
[[nodiscard]] BundleAdjustmentResult AdjustBundle(const BundleAdjustmentState& start,
                                                  const std::vector<BoardView>& views,
                                                  const BundleAdjustmentOptions& options);

/// The information that the views hold about the camera's parameters when the poses are unknown:
///
///     sum over views of  J'J - J'P (P'P)^-1 P'J,   J = d pixels / d parameters, P = d pixels / d
///     pose
///
/// for corner noise of 1 px; divide by the noise's variance [px^2]. It is additive over views.
/// Fixed parameters have zero rows and columns.
[[nodiscard]] Eigen::MatrixXd CameraInformation(const BundleAdjustmentState& state,
                                                const std::vector<BoardView>& views,
                                                const std::vector<bool>& fixed_parameters);

/// The pose of one view that fits best with the camera held (Gauss-Newton with damping); the start
/// itself where a corner does not project from it.
[[nodiscard]] Rigid3 RefinedPose(const CameraModel& model, const BoardView& view,
                                 const Rigid3& T_c_g_start, int max_iterations);

/// Residuals of one view, 2 x N, predicted - measured [px]. NaN where a corner does not project.
[[nodiscard]] Eigen::Matrix2Xd ReprojectionResiduals(const CameraModel& model,
                                                     const BoardView& view, const Rigid3& T_c_g);

}  // namespace calibrato
