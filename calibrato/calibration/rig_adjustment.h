#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/calibration/board_bending.h"
#include "calibrato/calibration/camera_fit.h"
#include "calibrato/calibration/camera_relations.h"
#include "calibrato/calibration/camera_rig_calibration.h"

namespace calibrato {

/// A group of cameras adjusted together.
struct RigAdjustment {
  Termination termination = Termination::kNoStart;
  CameraGroup group;  ///< With T_cn_cnm1 as adjusted.
  BoardBending bending;
  int num_separated_views = 0;
  int num_rounds = 0;  ///< Of adjustment and judgement, until nothing changed any more.
  /// Of one coordinate, by camera of the group, from the residuals and the degrees of freedom they
  /// have left [px].
  std::vector<double> noise_stddev_px;
  /// Of the group's border (bundle_adjustment.h), scaled by the noise; nothing where the data leave
  /// some of it undetermined.
  std::optional<Eigen::MatrixXd> covariance;
};

/// Adjusts the group's cameras, their relations, the poses of its frames and, if asked for, the
/// board's bending, from the cameras' own fits, which are then brought up to date (models, poses,
/// which corners take part). A view that does not fit the others of its frame becomes a frame of
/// its own; one that its camera alone had left out is taken back in where it fits them. One camera
/// before a flat board is adjusted already: only noise and covariance are found.
[[nodiscard]] RigAdjustment AdjustRig(const CameraRigProblem& problem, const CameraGroup& group,
                                      int max_iterations, std::vector<CameraFit>* fits);

}  // namespace calibrato
