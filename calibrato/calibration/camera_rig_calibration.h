#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/calibration/board_bending.h"
#include "calibrato/calibration/bundle_adjustment.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/sensors/board.h"

namespace calibrato {

/// One to N cameras, rigidly mounted, that saw one board, now and then at the same time.
struct CameraRigProblem {
  std::vector<CameraProblem> cameras;  ///< At least one.
  /// [camera][view]: the frame that a view is a part of (frame_matching.h). Each camera's are
  /// ascending without repetition; numbers may be left out.
  std::vector<std::vector<int>> frame_of_view;
  bool estimate_bending = false;  ///< One board, one bending, for all cameras.
  /// The board, where it is known. One that looks the same from several sides may have been
  /// numbered differently by each camera; of what frames they share, that is put right.
  std::optional<Board> board;
};

/// Where a camera is from one before it, but not the one right before it.
struct EarlierRelation {
  int camera = 0;
  Rigid3 T_cn_camera;
};

struct EstimatedBending {
  BoardBending bending;
  Eigen::Matrix3d covariance;  ///< Of its coefficients [1/m^2].
  double depth_m = 0.0;        ///< From the lowest to the highest point of the board [m].
};

struct CameraRigCalibration {
  Termination termination = Termination::kNoStart;  ///< The worst of all parts.
  /// Each camera's part: T_c_g are poses in its own frame, covariance its own block. With estimated
  /// bending, the used views' points are those of the bent board.
  std::vector<CameraCalibration> cameras;
  /// Entry n-1: from camera n-1 to camera n; nothing where they could not be related.
  std::vector<std::optional<Rigid3>> T_cn_cnm1;
  /// Entry n-1: set where camera n is not related to camera n-1 but to one before that, as where
  /// camera n-1 never saw the board together with them.
  std::vector<std::optional<EarlierRelation>> earlier_relations;
  /// Cameras that are related, but for the sides of a board that looks the same from several
  /// (CameraGroup::is_side_known).
  std::vector<std::vector<int>> groups_of_unknown_side;
  std::vector<int> num_shared_frames;  ///< Entry n-1: in which cameras n-1 and n are both used.
  /// Views that fit on their own but not together with the other cameras' of their frame, as when
  /// the rig moved between images that count as simultaneous: used for their camera alone.
  int num_separated_views = 0;
  /// "cam0.fu", .., "cam1.rot_x", ..; where an earlier relation stands, "cam2.from_cam0.rot_x".
  std::vector<std::string> covariance_names;
  /// Marginal covariance of everything in covariance_names, scaled by the estimated noise (zero
  /// rows and columns for what was held; zero between cameras that are not related). Cameras
  /// without a covariance are left out of both.
  Eigen::MatrixXd covariance;
  std::optional<EstimatedBending> bending;  ///< Where it was asked for and could be estimated.
};

/// Calibrates each camera on its own (start values, outliers), relates them by the frames that
/// several saw, and adjusts all together, each camera weighted by its own noise. Cameras without
/// shared frames keep their own solution. A camera that can't be calibrated has a result without a
/// model, and does not stop the others.
/// @throws InputError as CalibrateCamera; and where bending is to be estimated, but not all of the
/// calibrated cameras are related (each part would find another bending of the one board), or the
/// board looks the same after a quarter turn (it may have been numbered anew from view to view).
[[nodiscard]] CameraRigCalibration CalibrateCameraRig(const CameraRigProblem& problem,
                                                      int max_iterations = 200);

}  // namespace calibrato
