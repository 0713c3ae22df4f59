#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/calibration/board_bending.h"
#include "calibrato/calibration/termination.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// One camera's view of the board in one frame: an instant at which one or several of the rig's
/// cameras took an image.
struct BundleView {
  int camera = 0;
  int frame = 0;
  const BoardView* view = nullptr;  ///< Not owned.
};

/// Views of one camera: each is a frame of its own.
[[nodiscard]] std::vector<BundleView> ViewsOfOneCamera(const std::vector<BoardView>& views);

/// What is adjusted, so that the sum of squared reprojection errors (predicted - measured, [px]) is
/// least. Camera n sees board point p at T_cn_c0 * T_c0_g * p with
/// T_cn_c0 = T_cn_cnm1 * .. * T_c1_c0.
struct BundleAdjustmentState {
  std::vector<CameraModel> models;  ///< One a camera.
  std::vector<Rigid3> T_cn_cnm1;    ///< Entry n-1 is that of camera n; one less than cameras.
  std::vector<Rigid3> T_c0_g;       ///< One a frame, whether or not camera 0 saw the board in it.
  BoardBending bending;             ///< Of the one board that all views show.

  [[nodiscard]] Rigid3 T_cn_c0(int camera) const;
};

struct BundleAdjustmentOptions {
  int max_iterations = 100;
  /// How cautious the first step is, as a share of the normal equations' diagonal: 1e-4 from rough
  /// start values, much less from good ones.
  double initial_damping = 1e-4;
  /// Converged when a step promises to lower the cost by less than this share of it [-].
  double cost_tolerance = 1e-12;
  /// Parameters that keep their start value, by camera and index; an empty entry (or none at all)
  /// means that camera's are all free.
  std::vector<std::vector<bool>> fixed_parameters;
  /// If set, the board's bending is estimated too. Not owned.
  const BendingShapes* bending_shapes = nullptr;
  /// The noise of each camera's corners [px], by which its errors are divided; empty means 1. With
  /// it, costs and information are in units of these.
  std::vector<double> noise_stddev_px;
  /// If > 0, corners count by Cauchy's loss s^2 log(1 + e^2 / s^2) of their error's length e, s
  /// being this scale [px]; else by e^2.
  double loss_scale_px = 0.0;
};

/// The border of the normal equations: what is left once the frames' poses are eliminated. For each
/// camera in turn its parameters and, from camera 1 on, the perturbation [dtheta, dt] of its
/// T_cn_cnm1 (geometry/rigid3.h); bending last, where it is estimated.
struct BorderLayout {
  std::vector<int> parameters;  ///< Where each camera's begin.
  std::vector<int> chain;       ///< Where each camera's T_cn_cnm1 begins; -1 for camera 0.
  int bending = -1;             ///< Where a, b, c begin; -1 if not estimated.
  int size = 0;

  BorderLayout(const std::vector<CameraModel>& models, bool estimate_bending);
};

/// "cam0.fu", .., "cam1.rot_x", .., "cam1.pos_z", .., "board.bending_xx", "board.bending_xy",
/// "board.bending_yy" in the order of the border.
[[nodiscard]] std::vector<std::string> BorderNames(const std::vector<CameraModel>& models,
                                                   bool estimate_bending);

struct BundleAdjustmentResult {
  BundleAdjustmentState state;
  Termination termination = Termination::kIterationLimit;
  int num_iterations = 0;
  double cost_px2 = 0.0;  ///< Sum over corners of the loss: without one, of du^2 + dv^2.
};

/// Levenberg-Marquardt. The poses are eliminated frame by frame (each is a 6x6 block, seen by its
/// own views only), so that time and memory are linear in the number of frames. Frames are worked
/// on in parallel and reduced in their order.
/// @pre every corner projects at the start; views are ordered by frame; every frame has a view
[[nodiscard]] BundleAdjustmentResult AdjustBundle(const BundleAdjustmentState& start,
                                                  const std::vector<BundleView>& views,
                                                  const BundleAdjustmentOptions& options);

/// The information that the views hold about the border when the frames' poses are unknown:
///
///     sum over frames of  J'J - J'P (P'P)^-1 P'J,   J = d pixels / d border, P = d pixels / d pose
///
/// for corner noise of 1 px unless the options say otherwise; divide by the noise's variance
/// [px^2]. It is additive over frames. Fixed parameters have zero rows and columns. The loss is not
/// applied.
[[nodiscard]] Eigen::MatrixXd BorderInformation(const BundleAdjustmentState& state,
                                                const std::vector<BundleView>& views,
                                                const BundleAdjustmentOptions& options);

/// The same for one camera and flat boards; one pose a view, border = its parameters.
[[nodiscard]] Eigen::MatrixXd CameraInformation(const CameraModel& model,
                                                const std::vector<Rigid3>& T_c_g,
                                                const std::vector<BoardView>& views,
                                                const std::vector<bool>& fixed_parameters);

/// What the views of a frame say of its pose T_c0_g, for corner noise of 1 px unless the options
/// say otherwise. Joint covariance of border b and poses p (indices of frames v, w), Sigma =
/// Cov(b):
///     Cov(p_v, b) = D_v Sigma,   Cov(p_v, p_w) = D_v Sigma D_w' + [v = w] C_v.
struct FramePose {
  Eigen::Matrix<double, 6, 6> conditional_covariance;  ///< C_v: with the border held.
  Eigen::MatrixXd by_border;                           ///< D_v = d pose / d border, 6 x border.
};

/// One a frame, in their order.
[[nodiscard]] std::vector<FramePose> FramePoses(const BundleAdjustmentState& state,
                                                const std::vector<BundleView>& views,
                                                const BundleAdjustmentOptions& options);

}  // namespace calibrato
