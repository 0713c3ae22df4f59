#pragma once

#include <Eigen/Core>

#include "calibrato/calibration/board_bending.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// What one view contributes to a least-squares problem. The only part of the solvers that is
/// compiled once a camera model.
struct ViewRows {
  /// 2N rows (u and v of each corner in turn) by columns
  ///     [pose 6 | parameters n | bending 3 | residual 1],
  /// pose = perturbation [dtheta, dt] of T_cn_g (geometry/rigid3.h); parameters and bending only
  /// where asked for. With a loss, each corner's rows are multiplied by the root of its weight.
  Eigen::MatrixXd rows;
  double cost_px2 = 0.0;  ///< Sum of the loss over the corners.
};

struct ViewRowsOptions {
  bool parameters = true;
  const BendingShapes* shapes = nullptr;  ///< Bending's columns where it is set.
  BoardBending bending;                   ///< Only with shapes.
  double loss_scale_px = 0.0;             ///< Cauchy's; 0 for none.
};

/// False, with the rows in any state, where a corner does not project.
[[nodiscard]] bool LineariseView(const CameraModel& model, const BoardView& view,
                                 const Rigid3& T_cn_g, const ViewRowsOptions& options,
                                 ViewRows* result);

/// The pose of one view that fits best with the camera held (Gauss-Newton with damping); the start
/// itself where a corner does not project from it.
/// @param loss_scale_px  Of Cauchy's loss; 0 for least squares.
[[nodiscard]] Rigid3 RefinedPose(const CameraModel& model, const BoardView& view,
                                 const Rigid3& T_c_g_start, int max_iterations,
                                 double loss_scale_px = 0.0);

/// Residuals of one view, 2 x N, predicted - measured [px]. NaN where a corner does not project.
[[nodiscard]] Eigen::Matrix2Xd ReprojectionResiduals(const CameraModel& model,
                                                     const BoardView& view, const Rigid3& T_c_g);

}  // namespace calibrato
