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

/// How far parts of a recording, each calibrated alone, lie apart. A covariance rests on errors
/// that are independent from one corner and sample to the next; those of a lens that its model does
/// not fit, of a bent board, of a vibrating IMU are not. What they do to the result differs between
/// parts.
struct CameraImuScatter {
  int num_parts = 0;
  /// Squared distances of T_c_i and time offset to their mean over the parts, in their covariances,
  /// over their degrees of freedom, of the camera where it is largest. 1 where covariances tell the
  /// truth.
  double ratio = 1.0;
  double probability = 1.0;  ///< At most: that chance alone makes one camera's as large.
  /// By how much standard deviations are to be multiplied: sqrt(ratio) where that is significantly
  /// more than 1 (Birge, "The calculation of errors by the method of least squares", Physical
  /// Review 40, 1932), else 1. What all parts have in common no part shows.
  [[nodiscard]] double sigma_scale() const;
};

/// Nothing where a part does not determine all of it. @pre num_parts >= 2
[[nodiscard]] std::optional<CameraImuScatter> ScatterOfParts(
    const CameraImuProblem& problem, const CameraImuCalibration& calibration, int num_parts);

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
/// @param sigma_scale  By which both halves' standard deviations are multiplied.
[[nodiscard]] std::optional<CameraImuSplit> CheckSplit(const CameraImuProblem& problem,
                                                       const CameraImuCalibration& calibration,
                                                       double sigma_scale);

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
/// @param sigma_scale  By which standard deviations are multiplied.
/// @pre the calibration has a state
[[nodiscard]] std::vector<CameraImuKnowledge> KnowledgeOverTime(
    const CameraImuProblem& problem, const CameraImuCalibration& calibration, int max_parts,
    double sigma_scale);

/// Standard deviation of each of the border's parameters (names), also where others are not
/// determined; NaN for those that are not.
[[nodiscard]] std::vector<double> SigmasOf(const CameraImuInformation& information);

}  // namespace calibrato
