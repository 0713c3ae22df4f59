#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/comparison.h"

// What parts of a recording say of the camera-IMU calibration that the whole gave.

namespace calibrato {

/// An IMU's noise with the densities by which a calibration weighed its samples: as they were
/// given, or as they were estimated.
[[nodiscard]] ImuNoise NoiseAsFound(ImuNoise noise, const CameraImuWeights::Imu& weights);

/// The views and samples with begin <= stamp < end, each on its own clock.
[[nodiscard]] CameraImuProblem PartOf(const CameraImuProblem& problem, Time begin, Time end);

/// What the first and the second half of a recording, each calibrated alone, say of each other.
struct CameraImuSplit {
  struct Camera {
    /// Second less first: [dtheta [rad], dt [m]] of T_c_i, then the time offset [s].
    Eigen::Vector<double, 7> difference;
    Eigen::Vector<double, 7> sigma;  ///< Of the difference; 0 for a time offset that was held.
    Significance significance;
  };
  std::vector<Camera> cameras;
};

/// Nothing where a half does not determine all of it.
[[nodiscard]] std::optional<CameraImuSplit> CheckSplit(const CameraImuProblem& problem,
                                                       const CameraImuCalibration& calibration);

/// How well camera 0's extrinsics are known from the first so many seconds: root sums of squares
/// of the three sigmas. NaN while they are undetermined.
struct CameraImuKnowledge {
  double time_s = 0.0;  ///< From the trajectory's beginning.
  double rotation_sigma_rad = 0.0;
  double translation_sigma_m = 0.0;
  double time_offset_sigma_s = 0.0;
};

/// At up to `max_parts` times, evenly over the trajectory, the last of them its end; without
/// solving again.
/// @pre the calibration has a state
[[nodiscard]] std::vector<CameraImuKnowledge> KnowledgeOverTime(
    const CameraImuProblem& problem, const CameraImuCalibration& calibration, int max_parts);

/// Standard deviation of each of the border's parameters (names), also where others are not
/// determined; NaN for those that are not.
[[nodiscard]] std::vector<double> SigmasOf(const CameraImuInformation& information);

}  // namespace calibrato
