#pragma once

#include <Eigen/Core>
#include <string>

#include "calibrato/base/rng.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// Where simulated rigs are drawn from.
enum class RigDistribution {
  /// The paper's Table 4: field of view N(1.0, 0.05) rad, T_cam_imu around (0.06, 0, -0.1) m and
  /// (0, 0, 1.5708) rad with
  /// 0.01 m and 0.1 rad; and k1 k2 k3 ~ N(0, 0.1), redrawn until every pixel of the image has a
  /// ray.
  kPaper,
  /// The same with a lens that does not distort.
  kPaperUndistorted,
};
[[nodiscard]] std::string RigDistributionName(
    RigDistribution distribution);  ///< "paper", "paper-undistorted"
[[nodiscard]] RigDistribution RigDistributionFromName(
    const std::string& name);  ///< @throws InputError

/// A rig in the paper's scene. Its camera is pinhole-radtan5 in both distributions.
[[nodiscard]] Rig DrawRig(RigDistribution distribution, Rng& rng);

/// What is believed of fu fv pu pv before any data: the camera at the mean of Table 4 [px].
[[nodiscard]] Eigen::Vector4d PriorMeanIntrinsics();

}  // namespace calibrato
