#pragma once

#include <vector>

#include "calibrato/calibration/camera_fit.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/board_symmetry.h"

namespace calibrato {

/// Cameras that are related to each other by frames that several of them saw.
struct CameraGroup {
  std::vector<int> cameras;  ///< Ascending; at least one.
  /// Entry k-1: from cameras[k-1] to cameras[k]. One less than cameras.
  std::vector<Rigid3> T_cn_cnm1;
  /// False where the board looks the same from several sides and the shared frames do not tell
  /// which of them each camera saw: then the cameras are those turned least against each other.
  bool is_side_known = true;

  /// From one of the cameras to another, by their places in `cameras`.
  [[nodiscard]] Rigid3 T_to_from(size_t to, size_t from) const;
};

/// How many frames two cameras share, in which both are used.
[[nodiscard]] int NumSharedFrames(const CameraFit& a, const std::vector<int>& frame_of_view_a,
                                  const CameraFit& b, const std::vector<int>& frame_of_view_b);

/// Groups cameras by shared frames, and finds roughly where they are: cameras are joined in the
/// order of most shared frames, by the robust mean of T_cb_g * T_ca_g^-1 over these. Cameras that
/// were not fitted are groups of their own.
/// @param frame_of_view  As in CameraRigProblem.
/// @param turns          Of the board onto itself, by which cameras may number its points
///                       differently, from frame to frame: as the boards move, only one choice
///                       gives the same relation in all frames.
[[nodiscard]] std::vector<CameraGroup> RelateCameras(
    const std::vector<CameraFit>& fits, const std::vector<std::vector<int>>& frame_of_view,
    const std::vector<BoardTurn>& turns = {});

/// The mean of poses of which fewer than half may be wrong: from the one that is nearest to all
/// others, by iteratively reweighted averages.
/// @param length_m  A shift of this length weighs as much as a turn of 1 rad [m].
/// @pre at least one
[[nodiscard]] Rigid3 RobustMean(const std::vector<Rigid3>& poses, double length_m);

}  // namespace calibrato
