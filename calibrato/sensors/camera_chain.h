#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// One camera of a rig, as in an entry of Kalibr's camchain.yaml.
struct Camera {
  CameraModel model;
  Resolution resolution;
  std::string rostopic;             ///< Where its images are in a bag.
  std::optional<Rigid3> T_cn_cnm1;  ///< From the camera before it; none for the first.
};

/// Kalibr's camchain.yaml: cam0, cam1, .. in order. camera_model is pinhole, omni, ds or eucm;
/// distortion_model none, radtan, equidistant or fov, or radtan5, which is ours, not Kalibr's. A
/// pair that is no model (camera_model.h) is an error, and so is `intrinsics` or
/// `distortion_coeffs` of the wrong length.
/// @throws InputError with line and key. Unknown keys are appended to warnings (may be null).
[[nodiscard]] std::vector<Camera> CameraChainFromValue(const Value& value,
                                                       std::vector<std::string>* warnings);
[[nodiscard]] Value ToValue(const std::vector<Camera>& cameras);

/// A 4x4 matrix, four rows of four or sixteen numbers. @throws InputError unless its last row is 0
/// 0 0 1 and its rotation is one to 1e-3 (it is then projected to the nearest rotation).
[[nodiscard]] Rigid3 Rigid3FromValue(const Value& value);
[[nodiscard]] Value ToValue(const Rigid3& T_a_b);

}  // namespace calibrato
