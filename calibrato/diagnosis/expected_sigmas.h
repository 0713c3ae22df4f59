#pragma once

#include <string>
#include <vector>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/camera_imu_problem.h"
#include "calibrato/diagnosis/finding.h"

// What a recording would tell of each parameter, by the information of the poses that were seen,
// before the parameters themselves are solved for.

namespace calibrato {

/// One parameter that is to be calibrated.
struct ExpectedSigma {
  std::string name;     ///< "cam0.fu", "cam0.rot_x"
  double sigma = 0.0;   ///< [px], [-], [rad], [m] or [s]; NaN where the motion does not show it.
  double enough = 0.0;  ///< Sigmas up to this are; NaN where none is asked for (distortion).
  Verdict verdict = Verdict::kPass;
  std::string advice;  ///< What to record; empty where it is enough.
};

/// Of all parameters of a camera, from a calibration by these views. Focal lengths and principal
/// point are enough up to 1 % of the focal length (docs/formats.md section 1); above, inconclusive.
/// @param name  "cam0"
[[nodiscard]] std::vector<ExpectedSigma> ExpectedIntrinsics(const std::string& name,
                                                            const CameraProblem& problem,
                                                            const CameraCalibration& calibration);

/// Of rotation and translation of each camera's T_c_i and of its time offset, at the start values
/// of the solve (camera_imu_start.h). Enough up to 0.2 degrees, 5 mm, 0.5 ms; inconclusive above 1
/// degree, 20 mm, 5 ms; else warn. Sigmas fall with the root of time: more of the same motion is
/// advised where a minute of it would be enough, else a motion about the axis that lacks it.
/// @return empty where there are no start values.
/// @pre Streams are ascending and finite.
[[nodiscard]] std::vector<ExpectedSigma> ExpectedExtrinsics(const CameraImuProblem& problem);

/// "0.24 degrees", "1.3 mm", "0.05 ms", "2.1 px"; "none" where the motion does not show it.
[[nodiscard]] std::string SigmaText(const ExpectedSigma& parameter);

/// The parameters that are not enough, those of a camera and a kind (cam0.rot) in one finding with
/// the advice for the worst of them.
[[nodiscard]] std::vector<Finding> FindingsOnExpectedSigmas(
    const std::vector<ExpectedSigma>& expected);

}  // namespace calibrato
