#pragma once

#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/calibration/optimal_weights.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// The best that any motion could do for the intrinsic task: frames from anywhere, in any order.
struct PathFreeDesign {
  std::vector<Rigid3> T_c_g;    ///< Of the poses that are used, the most used first.
  std::vector<double> weights;  ///< Theirs, of sum 1.
  /// Trace of the covariance of fu fv pu pv with that many frames [px^2] ...
  double a_optimality = 0.0;
  /// ... and what no choice among the candidate poses can be better than.
  double lower_bound = 0.0;
};

/// The convex design (optimal_weights.h) over random poses of the controlled frame within the free
/// carrier's reach, from which the board is seen at least 8 px inside the image.
/// @param num_candidates  Poses to choose from.
/// @param num_frames      That the weights are spread over, as fractions.
[[nodiscard]] PathFreeDesign DesignFrames(const Rig& rig, int num_candidates, double num_frames,
                                          Rng& rng);

}  // namespace calibrato
