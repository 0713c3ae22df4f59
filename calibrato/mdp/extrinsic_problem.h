#pragma once

#include <vector>

#include "calibrato/calibration/camera_imu_problem.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// What the extrinsic task asks of room `calibration`, in training and in evaluation alike: pose
/// and time offset between camera 0, whose intrinsics are known (as the paper's camchain has the
/// truth), and the IMU, whose noise is known from its data sheet. The corners' noise is estimated
/// unless the caller sets it.
[[nodiscard]] CameraImuProblem ExtrinsicProblem(const Rig& rig, std::vector<BoardView> views,
                                                ImuStream imu);

}  // namespace calibrato
