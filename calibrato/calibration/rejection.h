#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace calibrato {

/// A corner that a robust fit left out.
struct RejectedCorner {
  std::string view;  ///< Its view's name.
  int corner_id = 0;
  Eigen::Vector2d pixel;     ///< Measured [px].
  Eigen::Vector2d residual;  ///< Predicted - measured [px]; NaN where it does not project.
};

/// Why a whole view was left out.
enum class ViewRejection {
  kTooFewCorners,  ///< Too few are left to determine the board's pose.
  kNoPose,         ///< No pose of the board explains it: corners in disorder, or on one line.
  kDoesNotFit,     ///< Most of its corners are far from where the camera would see them.
};

/// "too few corners", "no pose of the board explains it", "does not fit".
[[nodiscard]] std::string ViewRejectionName(ViewRejection reason);

struct RejectedView {
  std::string name;
  ViewRejection reason = ViewRejection::kNoPose;
  int num_corners = 0;
  double rms_px = 0.0;  ///< With the pose that fits best; NaN without a pose [px].
};

}  // namespace calibrato
