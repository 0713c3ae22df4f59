#pragma once

#include "calibrato/calibration/camera_imu_problem.h"
#include "calibrato/calibration/camera_imu_state.h"

namespace calibrato {

/// What the original implementation called A-optimality, the only number to be set beside the
/// paper's column: from the corners with sigma 1 px, the trajectory and all else taken as known,
/// the sum of the traces of the inverses of the rotation's and the translation's 3 x 3 blocks of
/// the normal equations [rad^2 + m^2]. (It read the 6 x 6 block from a matrix of which one triangle
/// was stored, so that rotation and translation came out as if one did not look like the other.
/// Before this board, from these distances, they do: the trace of the whole block's inverse is some
/// fifty times as large, and that of the marginal covariance is another number again.)
[[nodiscard]] double OriginalAOptimality(const CameraImuProblem& problem,
                                         const CameraImuState& state);

}  // namespace calibrato
