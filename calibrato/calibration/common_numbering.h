#pragma once

#include <vector>

#include "calibrato/calibration/camera_fit.h"
#include "calibrato/calibration/camera_relations.h"
#include "calibrato/calibration/camera_rig_calibration.h"

namespace calibrato {

/// Numbers the points of a board that looks the same from several sides alike in all views of a
/// frame. Each camera was searched on its own, and may have taken another side of the board for the
/// first: then frame g is not the same for the cameras. Of each frame the first of the group's
/// cameras keeps its numbers; the others' are those that place the board nearest to where it is
/// then.
/// A view that its camera left out (kDoesNotFit) of a frame that another camera used has the
/// numbers in which it fits that camera's best, so that it can be judged there.
/// @param turns    Of problem->board onto itself; at least one.
/// @param problem  Its views are numbered anew ..
/// @param fits     .. and their poses turned.
void NumberAlike(const CameraGroup& group, const std::vector<BoardTurn>& turns,
                 CameraRigProblem* problem, std::vector<CameraFit>* fits);

}  // namespace calibrato
