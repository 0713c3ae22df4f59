#pragma once

#include <vector>

#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// Where and how the board appears in one view, as in the paper's appendix A and ROS
/// image_pipeline, from the quadrilateral of its four outer corners with area a and s = sqrt(a):
struct ViewParameters {
  double x = 0.0;     ///< (mean u - s/2) / (W - s), clipped to [0, 1].
  double y = 0.0;     ///< (mean v - s/2) / (H - s), clipped to [0, 1].
  double size = 0.0;  ///< sqrt(a / (W H)).
  double skew = 0.0;  ///< min(1, 2 |pi/2 - angle at one outer corner|).
};

/// For partial views the corners nearest to the outer ones stand in for them.
[[nodiscard]] ViewParameters ViewParametersOf(const BoardView& view, Resolution resolution);

/// Progress of each range towards what is wanted, in [0, 1]: min((highest - lowest) / wanted, 1),
/// with wanted ranges X 0.7, Y 0.7, size 0.4, skew 0.5; the lowest size and skew count as 0.
struct Coverage {
  double x = 0.0;
  double y = 0.0;
  double size = 0.0;
  double skew = 0.0;
  [[nodiscard]] double sum() const { return x + y + size + skew; }
};

/// All zero without views.
[[nodiscard]] Coverage CoverageOf(const std::vector<BoardView>& views, Resolution resolution);

}  // namespace calibrato
